// Reading crowds: who is in one, one person out of it as a body with joints, and a motion for all.
// Of character_io.h, read_body and has_body_notes take addresses, too; read_character refuses them,
// and crowds, with the next step; check_output (atomic_file.h) knows that "crowd.glb#ada" is
// crowd.glb.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche {

struct CrowdText;  // the file's own words, opaque; see crowd_text.h

struct Crowd {
  std::vector<std::string> people;  // in the file's order
  std::shared_ptr<const CrowdText> text;
};

struct CrowdPerson {
  Body body;          // the skin, good to 0.03 mm; name, sex, age and mass as the crowd has them
  Skeleton skeleton;  // as it was fitted, in single precision
};

// One person of a crowd, as command lines name them: "crowd.glb#ada".
struct CrowdAddress {
  std::filesystem::path file;
  std::string person;
};

// Whether write_crowd may have written the file: by the mark in its text.
bool is_crowd(const std::filesystem::path& file);

// Nothing for anything but a crowd. Throws InputError for a crowd of whom nobody is named, and
// names the people there.
std::optional<CrowdAddress> crowd_address(const std::filesystem::path& file);

// Opens nothing but the file and, for a .gltf, what lies beside it. Throws InputError for a file
// that is no crowd of ours or of another schema.
Crowd open_crowd(const std::filesystem::path& file);

// Throws InputError for somebody who is not there, or whose data do not belong together.
CrowdPerson read_crowd_person(const Crowd& crowd, const std::string& name);

struct CrowdMotionOptions {
  std::string name;    // of the animation; not one that the crowd has already
  double stagger = 0;  // s by which each person begins later than the one before
};

// The crowd as one .glb in which all move: one animation, with `move`'s motion for each person,
// whose root is in the person's own frame (soles at the origin at rest). Throws OutputError,
// LimitError (4 GiB), UsageError for a name that is taken, std::invalid_argument for a motion of
// another skeleton.
void write_crowd_motion(const std::filesystem::path& file, const Crowd& crowd,
                        const CrowdMotionOptions& options,
                        const std::function<Motion(const CrowdPerson&)>& move);

}  // namespace ecorche
