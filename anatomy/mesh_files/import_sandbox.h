// What a program gives up before it reads a file that a stranger made. Linux.
#pragma once

namespace ecorche::inline v1 {

// Bounds time, memory and what is written (limits::kImportSeconds, kImportMemory, kImportBytes),
// and leaves the calling process no more of the system than memory, the descriptors that it has
// (written to: 1 and 2 alone) and its own end: no file is opened, no socket made, no program
// started. What asks for more is answered EPERM. False where the system cannot do that.
bool give_up_rights();

}  // namespace ecorche::inline v1
