// An MJCF file with its includes in place and its default classes resolved.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "anatomy/model_files/model_xml.h"

namespace ecorche::inline v1 {

class MjcfTree {
 public:
  // Reads `path` and what it includes. Throws InputError, LimitError.
  MjcfTree(const ModelFiles& files, const std::string& path);

  pugi::xml_node root() const { return document_.document_element(); }
  const std::string& name() const { return path_; }

  // The attribute of an element: its own, else its class's, else that of the class it lies in (""
  // for none), else "".
  std::string attribute(pugi::xml_node node, const char* name,
                        const std::string& childclass = "") const;
  // All elements of the top level with this name, in order (a file may have several).
  std::vector<pugi::xml_node> sections(const char* name) const;
  std::string where(pugi::xml_node node) const;

  bool degrees() const { return degrees_; }
  const std::string& euler_order() const { return euler_order_; }
  const std::string& mesh_folder() const { return mesh_folder_; }  // relative to the model's folder
  Transform placement(pugi::xml_node node, const std::string& childclass = "") const;

 private:
  void expand(pugi::xml_node node, const std::string& file, int depth);
  void defaults(pugi::xml_node node, const std::string& parent, int depth);

  using Attributes = std::map<std::string, std::string>;
  const ModelFiles& files_;
  std::string path_;
  pugi::xml_document document_;
  std::map<std::string, std::map<std::string, Attributes>>
      classes_;  // class -> element -> attributes
  bool degrees_ = true;
  std::string euler_order_ = "xyz", mesh_folder_;
  int included_ = 0;
};

}  // namespace ecorche::inline v1
