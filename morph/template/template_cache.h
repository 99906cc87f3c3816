// The template as it is kept in the cache (anatomy/files/cache.h).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "anatomy/files/assets.h"
#include "morph/template/template.h"

namespace ecorche::inline v1 {

// The template of build_template from the cache: $XDG_CACHE_HOME/ecorche, else ~/.cache/ecorche,
// else no cache. Built and stored when there is none, or a damaged one. The file's name is the hash
// of all it was built from, so that it is never stale.
Template read_template(const Assets& assets);

// As bytes. The fat tables are not part of them. read_template_bytes throws InputError for anything
// but what write_template_bytes gave.
std::string write_template_bytes(const Template& body_template);
Template read_template_bytes(std::string_view bytes, FatTables fat);

// Hash of everything that a template is built from: our tables, among them the pins of the
// packages, and the building code. `tables`: Assets::tables.
std::string template_key(const std::filesystem::path& tables);

}  // namespace ecorche::inline v1
