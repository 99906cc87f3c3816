// Figures of an anatomy's check in the report.
#pragma once

#include "app/report.h"
#include "skinning/checks/anatomy_check.h"
#include "skinning/checks/bulges.h"

namespace ecorche {

// Sets the figures under `check`.
void report_anatomy_check(const AnatomyCheck& check, Report& report);

// Under `check.bulge`.
void report_bulges(const Bulges& bulges, Report& report);

}  // namespace ecorche
