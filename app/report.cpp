#include "app/report.h"

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "anatomy/files/atomic_file.h"

namespace ecorche {

using Json = nlohmann::ordered_json;

struct Report::Impl {
  Json root = Json::object();

  Json& at(std::string_view name) {
    Json* node = &root;
    for (size_t dot; (dot = name.find('.')) != std::string_view::npos; name.remove_prefix(dot + 1))
      node = &(*node)[std::string(name.substr(0, dot))];
    return (*node)[std::string(name)];
  }
};

namespace {

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace

Report::Report() : impl_(std::make_unique<Impl>()) {}
Report::~Report() = default;
Report::Report(Report&&) noexcept = default;
Report& Report::operator=(Report&&) noexcept = default;

void Report::set(std::string_view name, double value) { impl_->at(name) = finite_or_null(value); }
void Report::set(std::string_view name, int value) { impl_->at(name) = value; }
void Report::set(std::string_view name, const std::string& value) { impl_->at(name) = value; }
void Report::set_flag(std::string_view name, bool value) { impl_->at(name) = value; }

void Report::set_list(std::string_view name, const std::vector<double>& values) {
  Json list = Json::array();
  for (double value : values) list.push_back(finite_or_null(value));
  impl_->at(name) = std::move(list);
}

void Report::append_text(std::string_view name, const std::string& value) {
  impl_->at(name).push_back(value);
}

double Report::number(std::string_view name) const {
  const Json* node = &impl_->root;
  while (true) {
    const size_t dot = name.find('.');
    const std::string key(name.substr(0, dot));
    if (!node->is_object() || !node->contains(key)) return std::numeric_limits<double>::quiet_NaN();
    node = &(*node)[key];
    if (dot == std::string_view::npos) break;
    name.remove_prefix(dot + 1);
  }
  return node->is_number() ? node->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

// Names and paths may hold any bytes; bytes that are not UTF-8 are replaced.
std::string Report::to_json() const {
  return impl_->root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string Report::to_text() const {
  std::string out;
  const std::function<void(const Json&, const std::string&)> add = [&](const Json& node,
                                                                       const std::string& name) {
    if (node.is_object())
      for (const auto& [key, value] : node.items())
        add(value, name.empty() ? key : name + "." + key);
    else
      out += name + " " +
             (node.is_string() ? node.get<std::string>()
                               : node.dump(-1, ' ', false, Json::error_handler_t::replace)) +
             "\n";
  };
  add(impl_->root, "");
  return out;
}

void Report::write(const std::filesystem::path& file) const {
  write_file_atomically(file, to_json());
}

}  // namespace ecorche
