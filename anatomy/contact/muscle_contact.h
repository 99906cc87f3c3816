// Contact between muscles, a stage after posing: muscles that a pose has moved into one another are
// separated and get their rest volumes back.
//
// Overlapping outlines are both cut back to where their normalised radii are equal
// (section_contact.h); then each belly is scaled to its volume (restore_volume.h). The rest pose is
// unchanged bit for bit. Which sections may meet is known beforehand (contact_candidates.h).
#pragma once

#include <span>

#include "anatomy/compute/threads.h"
#include "anatomy/contact/contact_table.h"
#include "anatomy/contact/section_contact.h"
#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "anatomy/posing/restore_volume.h"

namespace ecorche::inline v1 {

// All memory of contact, owned by the caller and sized by its first use. Its content has no meaning
// between calls; one a thread.
struct ContactWorkspace {
  SectionContactWorkspace sections;
  VolumeWorkspace volumes;
};

// Right after pose_anatomy(): the pairs with much overlap. Updates PosedAnatomy::clamped. The same
// bytes at any number of threads.
void resolve_posed_contact(const ContactTable& table, const PosingTable& posing,
                           PosedAnatomy& posed, ContactWorkspace& workspace, Threads threads);

// After another stage has moved sections or changed outlines: all pairs. `blocked` (#sections, or
// empty): where something other than muscles keeps an outline from growing, 0 free .. 1. Sets
// `state`.
void resolve_muscle_contact(const ContactTable& table, const PosingTable& posing,
                            std::span<const RadialSamples> blocked, PosedAnatomy& posed,
                            ContactState& state, ContactWorkspace& workspace, Threads threads);

// Once more, for sections that lay deep in others in the pass before, of which `state` tells;
// updates it. Contact that was hardly deep counts in part, so that nothing jumps. Throws
// std::invalid_argument for a state that no pass over this table has set.
void resolve_deep_contact(const ContactTable& table, const PosingTable& posing,
                          std::span<const RadialSamples> blocked, PosedAnatomy& posed,
                          ContactState& state, ContactWorkspace& workspace, Threads threads);

}  // namespace ecorche::inline v1
