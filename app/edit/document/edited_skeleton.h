// The skeleton of a document: the built-in one with joints and bones added, taken away and changed.
#pragma once

#include <string>
#include <vector>

#include "anatomy/rearrange_joints.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

// Whether it has joints or bones of its own, or lacks built-in ones.
bool has_own_parts(const Document& document);

// Names with sides of a joint as documents name it: NAME_l and NAME_r where a skeleton has these.
std::vector<std::string> sided_names(const Skeleton& skeleton, const std::string& name);
// Names without sides, in the order of the tree: what is added at the end, what is taken away left
// out.
std::vector<std::string> joint_names(Workshop& workshop, const Document& document);

// Whether a joint, by its name without side, is one of a pair.
bool is_paired(Workshop& workshop, const Document& document, const std::string& joint);
// Whether a name, with a side or without, is a joint's.
bool has_joint(Workshop& workshop, const Document& document, const std::string& name);
// Throws InputError, of the argument `key`, where it is none, with the most similar name.
void check_joint(Workshop& workshop, const Document& document, const std::string& name,
                 const char* key = "joint");

// Built-in joints and those of one's own behind them, where one between others hangs as a leaf.
// Throws InputError for places that do not read.
Skeleton edited_joints(Workshop& workshop, const Document& document);

// The source skeleton (Workshop::source) with edited_joints() and bones of its own behind the
// built-in ones. Of a finger or toe that is taken away the bones are left out; its joints stay,
// since motions and feet go by them. Throws as edited_joints().
Anatomy edited_source(Workshop& workshop, const Document& document);

// A bone of one's own in the source frame, left side or middle.
TriMesh placed_bone(Workshop& workshop, const Document& document, const OwnBone& bone);

// Changes a built-in template's skeleton and bones; its muscles stay. Precondition: as
// Workshop::base.
void edit_skeleton(Workshop& workshop, const Document& document, Template& out);

// What is left to do once a body is fitted: joints that stand between two others.
JointParents joint_parents(const Document& document);

// Names of a built-in joint, and of all built-in ones that hang on it, without sides.
std::vector<std::string> joints_with(Workshop& workshop, const std::string& joint);

}  // namespace ecorche
