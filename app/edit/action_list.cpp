#include "app/edit/action_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/similar_names.h"

namespace ecorche {
namespace {

constexpr const char *kMuscle = "muscle", *kLine = "line", *kWrap = "wrap", *kSkeleton = "skeleton",
                     *kBody = "body", *kTry = "try", *kSession = "session";

const std::vector<ActionKind>& kinds() {
  static const std::vector<ActionKind> all{
      {"pick", kMuscle, "Mean this muscle where an action names none", "biceps_brachii_long",
       Pick{}},
      {"new_muscle", kMuscle, "Make a muscle on bones: a straight line with a fusiform belly",
       "extra_flexor from=coracoid_tip to=rad_20_medial volume=60ml", NewMuscle{}},
      {"copy_muscle", kMuscle, "Make another muscle just like one", "soleus as=soleus_2",
       CopyMuscle{}},
      {"remove_muscle", kMuscle, "Take a muscle away", "palmaris_longus", RemoveMuscle{}},
      {"rename_muscle", kMuscle, "Give a muscle another name", "plantaris as=plantaris_2",
       RenameMuscle{}},
      {"mirror_muscle", kMuscle, "Make the sides alike again where they differ",
       "anconeus from=right", MirrorMuscle{}},
      {"set_muscle", kMuscle, "Set volume, fibre length, pennation, force, tendon",
       "soleus volume=480ml pennation=28", SetMuscle{}},
      {"describe_muscle", kMuscle, "Set label, region, layer, and what people read of a muscle",
       "soleus layer=superficial \"note=seen in dissection\"", DescribeMuscle{}},
      {"import_muscle", kMuscle, "Take a muscle from a file of export_muscle", "soleus.txt",
       ImportMuscle{}},
      {"resample_mesh", kMuscle, "Make a muscle of a mesh: sections along an action line",
       "my_biceps file=biceps.obj", ResampleMesh{}},
      {"paint_end", kLine, "Spread a muscle's ends over an area of bone",
       "soleus end=insertion places=calcaneus@70,40,-230;calcaneus@82,40,-230", PaintEnd{}},
      {"move_point", kLine, "Move a point of an action line in space, to a place, or onto a bone",
       "biceps_brachii_long point=3 by=0,0,5", MovePoint{}},
      {"add_point", kLine, "Lead an action line through one more point",
       "soleus at=tibia_level_40+0,0,-30", AddPoint{}},
      {"remove_point", kLine, "Take a point of an action line away", "biceps_brachii_long point=4",
       RemovePoint{}},
      {"set_section", kLine, "Set width, thickness and roll of a section, or make one",
       "biceps_brachii_long at=0.5 width=38mm thickness=30mm", SetSection{}},
      {"remove_section", kLine, "Take a section away", "biceps_brachii_long at=0.52",
       RemoveSection{}},
      {"scale_sections", kLine, "Make all sections wider, thicker, or turn them",
       "biceps_brachii_long width=1.2", ScaleSections{}},
      {"set_belly", kLine, "Slide the ends of the flesh along the line",
       "biceps_brachii_long begin=0.3 end=0.78", SetBelly{}},
      {"add_strip", kLine, "Lay one more strip beside another", "sartorius by=6,0,0", AddStrip{}},
      {"remove_strip", kLine, "Take a strip away", "brachialis strip=2", RemoveStrip{}},
      {"new_wrap", kWrap, "Make a sphere, cylinder or ellipsoid that lines slide over",
       "my_pulley sphere at=asis+0,-20,5 radius=12", NewWrap{}},
      {"set_wrap", kWrap, "Move or shape a wrap", "elbow_front radius=20", SetWrap{}},
      {"remove_wrap", kWrap, "Take away a wrap that no line slides over", "my_pulley",
       RemoveWrap{}},
      {"use_wrap", kWrap, "Let a line slide over a wrap", "soleus wrap=ankle_front", UseWrap{}},
      {"leave_wrap", kWrap, "Let a line slide over a wrap no more",
       "biceps_brachii_long wrap=elbow_front", LeaveWrap{}},
      {"move_joint", kSkeleton, "Move a joint's centre; bones and muscles stay", "elbow by=0,2,0",
       MoveJoint{}},
      {"turn_axes", kSkeleton, "Turn a joint's axes", "elbow rotation=4", TurnAxes{}},
      {"set_limits", kSkeleton, "Set how far a joint goes about one of its axes",
       "elbow flexion min=0 max=150", SetLimits{}},
      {"snap_joint", kSkeleton, "Put a joint's centre where the skin says that it is", "elbow",
       SnapJoint{}},
      {"reset_joint", kSkeleton, "Make a joint the built-in one again", "elbow", ResetJoint{}},
      {"set_group", kSkeleton, "Scale a group of bones: length, width, taper, bow and the like",
       "femur length=1.05 width=1.1 bow_depth=4mm", SetGroup{}},
      {"reset_group", kSkeleton, "Let the skin alone shape a group of bones again", "femur",
       ResetGroup{}},
      {"add_joint", kSkeleton, "Make a joint: of a tail, a sixth finger, between two of the spine",
       "tail pelvis at=coccyx+0,-4,-4 to=coccyx+0,-60,-60", AddJoint{}},
      {"add_bone", kSkeleton, "Hang a mesh of one's own on a joint, as its bone",
       "tail_bone tail file=tail.obj unit=mm", AddBone{}},
      {"set_bone", kSkeleton, "Move, turn or scale a bone of one's own", "tail_bone by=0,0,-5",
       SetBone{}},
      {"remove_bone", kSkeleton, "Take a bone of one's own away", "tail_bone", RemoveBone{}},
      {"remove_joint", kSkeleton, "Take away a joint of one's own, a finger or a toe",
       "mcp5 muscles=remove", RemoveJoint{}},
      {"restore_joint", kSkeleton, "Bring a finger or toe back that was taken away", "mcp5",
       RestoreJoint{}},
      {"set_body", kBody, "Put the muscles into another body", "anna.glb", SetBody{}},
      {"set_measure", kBody, "Ask the body for a measure", "waist_girth 78cm", SetMeasure{}},
      {"free_measure", kBody, "Ask for a measure no more", "waist_girth", FreeMeasure{}},
      {"set_layer", kBody, "Make the fat over the muscles thicker or thinner", "0.8", SetLayer{}},
      {"set_fit", kBody, "Say how muscles grow to the skin: method, alpha, rays, slices", "rays=32",
       SetFit{}},
      {"pose", kTry, "Take a pose of the pose book, or rest", "squat", SetPose{}},
      {"turn_joint", kTry, "Turn a joint to these angles", "elbow flexion=90", TurnJoint{}},
      {"activate", kTry, "Set the activation of muscles, for good or at a moment of the motion",
       "biceps_brachii* value=1", Activate{}},
      {"relax", kTry, "Take an activation away, or one key of its curve", "biceps_brachii*",
       Relax{}},
      {"play_motion", kTry, "Take poses from a motion", "walk.bvh", PlayMotion{}},
      {"show_moment", kTry, "Show a moment of the motion", "0.5s", ShowMoment{}},
      {"compare", kTry, "See another skin, what was before, or another body beside it",
       "linear_blend how=wiped", Compare{}},
      {"undo", kSession, "Take actions back, without end", "", Undo{}},
      {"redo", kSession, "Do again what was taken back", "", Redo{}},
      {"save", kSession, "Write the project as a folder of text", "my-arm", Save{}},
      {"export_muscle", kSession, "Write one muscle as text, for another project",
       "soleus soleus.txt", ExportMuscle{}},
      {"write_character", kSession, "Fit, bind and write the character", "arm.glb",
       WriteCharacter{}},
      {"write_template", kSession, "Write muscles and bones for `ecorche fit --template`",
       "my-template.glb", WriteTemplate{}},
      {"write_model", kSession, "Fit it and write a model for OpenSim (.osim) or MuJoCo (.xml)",
       "my-arm.osim", WriteModel{}},
      {"render", kSession, "Take a picture of what is tried",
       "arm.png look_at=biceps_brachii_long_l layers=muscles,bones", Render{}},
      {"film", kSession, "Film what is tried: around it, or with several cameras and cuts",
       "arm.mp4 \"shots=front 2s; around 6s\"", Film{}},
      {"report", kSession, "Print a muscle's length, volume, force, and moment arm",
       "biceps_brachii_long joint=elbow", ReportMuscle{}},
      {"curves", kSession,
       "Write a muscle's length, speed, moment arm, force and bulge over the motion",
       "curves.csv biceps_brachii_long joint=elbow", WriteCurves{}},
      {"check_bones", kSession,
       "Print the points of bones that lie deeper or less deep than people's", "", CheckBones{}},
  };
  return all;
}

const ActionKind& kind_of(const Action& action) {
  return *std::ranges::find_if(
      kinds(), [&](const ActionKind& kind) { return kind.fresh.index() == action.index(); });
}

std::string what_it_takes(const ArgumentInfo& each) {
  if (!each.words.empty()) return fmt::format("{}", fmt::join(each.words, "|"));
  return each.unit == ArgumentUnit::none ? each.kind : each.kind + " " + unit_name(each.unit);
}

}  // namespace

std::span<const ActionKind> action_kinds() { return kinds(); }

std::optional<Action> read_action(std::string_view line) {
  std::vector<std::string> words = split_words(line);
  if (words.empty()) return std::nullopt;
  const auto kind = std::ranges::find(kinds(), words.front(), &ActionKind::name);
  if (kind == kinds().end()) {
    std::vector<std::string> names;
    for (const ActionKind& each : kinds()) names.push_back(each.name);
    throw InputError(fmt::format("'{}' is no action{}; `ecorche studio --list-actions` names them",
                                 words.front(), did_you_mean(words.front(), names)));
  }
  words.erase(words.begin());
  Action action = kind->fresh;
  try {
    ArgumentReader reader(words);
    std::visit([&](auto& x) { arguments(reader, x); }, action);
    reader.end();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", kind->name, error.what()));
  }
  return action;
}

std::string action_line(const Action& action) {
  const ActionKind& kind = kind_of(action);
  ArgumentWriter before;
  Action fresh = kind.fresh, copy = action;
  std::visit([&](auto& x) { arguments(before, x); }, fresh);
  ArgumentWriter writer(before.values());
  std::visit([&](auto& x) { arguments(writer, x); }, copy);
  return kind.name + writer.line();
}

std::vector<ArgumentInfo> arguments_of(const ActionKind& kind) {
  ArgumentLister lister;
  Action fresh = kind.fresh;
  std::visit([&](auto& x) { arguments(lister, x); }, fresh);
  return lister.list();
}

std::string list_of_actions() {
  std::string out, group;
  for (const ActionKind& kind : kinds()) {
    if (group != kind.group) out += fmt::format("{}{}\n", out.empty() ? "" : "\n", kind.group);
    group = kind.group;
    out += fmt::format("  {:<16} {}\n", kind.name, kind.help);
    for (const ArgumentInfo& each : arguments_of(kind))
      out += fmt::format("    {:<14} {:<22} {}{}\n", each.key, what_it_takes(each), each.help,
                         each.required ? "" : " (optional)");
    if (*kind.example) out += fmt::format("    as: {} {}\n", kind.name, kind.example);
  }
  return out;
}

std::string list_of_actions_json() {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const ActionKind& kind : kinds()) {
    nlohmann::ordered_json each{{"name", kind.name}, {"group", kind.group}, {"help", kind.help}};
    each["example"] = fmt::format("{}{}{}", kind.name, *kind.example ? " " : "", kind.example);
    each["arguments"] = nlohmann::ordered_json::array();
    for (const ArgumentInfo& info : arguments_of(kind)) {
      nlohmann::ordered_json one{{"name", info.key}, {"kind", info.kind}};
      if (info.unit != ArgumentUnit::none) one["unit"] = unit_name(info.unit);
      if (!info.words.empty()) one["words"] = info.words;
      one["required"] = info.required;
      one["help"] = info.help;
      each["arguments"].push_back(std::move(one));
    }
    out.push_back(std::move(each));
  }
  return out.dump(2) + "\n";
}

std::optional<Document> applied(Workshop& workshop, const Document& document,
                                const Action& action) {
  return std::visit(
      [&](const auto& x) -> std::optional<Document> {
        if constexpr (requires { apply(workshop, document, x); })
          return apply(workshop, document, x);
        else
          return std::nullopt;
      },
      action);
}

}  // namespace ecorche
