// Reads crowds: who is in one, and one person as a body with joints. app/files/open_character.h
// and open_body.h take the address of a person wherever they take a file; check_output
// (atomic_file.h) knows that "crowd.glb#ada" is crowd.glb.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

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

// Throws InputError for a crowd or one of its people, who are no characters before they have been
// fitted: for verbs that need a character's file.
void refuse_crowd(const std::filesystem::path& file);

// Opens nothing but the file and, for a .gltf, what lies beside it. Throws InputError for a file
// that is no crowd of ours or of another schema.
Crowd open_crowd(const std::filesystem::path& file);

// Throws InputError for somebody who is not there, or whose data do not belong together.
CrowdPerson read_crowd_person(const Crowd& crowd, const std::string& name);

}  // namespace ecorche::inline v1
