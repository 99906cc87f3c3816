// Pictures of the demo's report page: figures 2 and 4 to 7 of the template paper, made from this
// run.
#pragma once

#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "app/files/fitted_actor.h"
#include "app/pages/demo_page.h"

namespace ecorche {

// The template fitted into a body, stage by stage (figures 4 and 5).
Picture picture_of_fit(const Template& body_template, const Body& body, const FittedActor& fitted,
                       const BodyPackage& package, const std::string& caption);

Picture picture_of_muscles(const FittedActor& fitted, const BodyPackage& package);  // figure 2
Picture picture_of_jump(const Actor& actor, const BodyPackage& package, const Motion& jump,
                        const DemoRecord& record);  // figure 6
Picture picture_of_walk(const Actor& actor, const BodyPackage& package,
                        const Motion& walk);  // figure 7

}  // namespace ecorche
