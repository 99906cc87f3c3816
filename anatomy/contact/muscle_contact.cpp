#include "anatomy/contact/muscle_contact.h"

#include <stdexcept>

#include "anatomy/posing/posing_data.h"

namespace ecorche::inline v1 {
namespace {

LaterPass later_pass(const ContactTable& table, const PosingTable& posing,
                     std::span<const RadialSamples> blocked, const PosedAnatomy& posed) {
  return {table.all, posed.X_WJ[0].translation(), posing.data->outlines, blocked};
}

}  // namespace

void resolve_posed_contact(const ContactTable& table, const PosingTable& posing,
                           PosedAnatomy& posed, ContactWorkspace& workspace, Threads threads) {
  if (table.major.empty()) return;
  resolve_rest_outlines(table.major, posed.X_WJ[0].translation(), posed.slices, workspace.sections,
                        threads);
  restore_volumes(posing, workspace.sections.changed, posed, workspace.volumes, threads,
                  kMostFirstScale);
  posed.clamped = clamped_strips(posed);
}

void resolve_muscle_contact(const ContactTable& table, const PosingTable& posing,
                            std::span<const RadialSamples> blocked, PosedAnatomy& posed,
                            ContactState& state, ContactWorkspace& workspace, Threads threads) {
  if (table.all.empty()) return;
  resolve_all_outlines(later_pass(table, posing, blocked, posed), posed.slices, state,
                       workspace.sections, threads);
  restore_volumes(posing, workspace.sections.changed, posed, workspace.volumes, threads);
}

void resolve_deep_contact(const ContactTable& table, const PosingTable& posing,
                          std::span<const RadialSamples> blocked, PosedAnatomy& posed,
                          ContactState& state, ContactWorkspace& workspace, Threads threads) {
  if (table.all.empty()) return;
  if (state.depth.size() != table.all.members.size())
    throw std::invalid_argument("resolve_deep_contact: no pass over this table has set the state");
  resolve_deep_outlines(later_pass(table, posing, blocked, posed), posed.slices, state,
                        workspace.sections, threads);
  restore_volumes(posing, workspace.sections.changed, posed, workspace.volumes, threads);
}

}  // namespace ecorche::inline v1
