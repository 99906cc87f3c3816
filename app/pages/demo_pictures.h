// The pictures of the demo's report page: what the template paper shows in its figures 2 and 4 to
// 7, made from this run.
#pragma once

#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "app/pages/demo_page.h"
#include "morph/fit/fit_character.h"

namespace ecorche {

// The template fitted into a body, stage by stage (figures 4 and 5).
Picture picture_of_fit(const Template& body_template, const Body& body,
                       const FittedCharacter& fitted, const BodyPackage& package,
                       const std::string& caption);

Picture picture_of_muscles(const FittedCharacter& fitted, const BodyPackage& package);  // figure 2
Picture picture_of_jump(const Actor& actor, const BodyPackage& package, const Motion& jump,
                        const DemoRecord& record);  // figure 6
Picture picture_of_walk(const Actor& actor, const BodyPackage& package,
                        const Motion& walk);  // figure 7

}  // namespace ecorche
