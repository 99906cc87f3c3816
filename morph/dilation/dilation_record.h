// What a dilation leaves for one of nearly the same muscles: those that are held come out as they
// did, and the others grow among them, round after round, as they would among all.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "morph/dilation/bone_rays.h"

namespace ecorche::inline v1 {

// A round of pack_muscles.
struct PackingRound {
  std::vector<SliceOutline> outlines;  // #slices, as it ended
  std::vector<double> needs;           // #muscles, as it began
};

struct DilationRecord {
  std::vector<std::size_t> muscle_begin;  // #muscles + 1, slices
  std::shared_ptr<const BoneRays> bones;
  std::vector<std::vector<Ellipse>> stages;  // #slices each, one after the other
  std::vector<PackingRound> packing;
  std::vector<Ellipse> finished;  // #slices
};

struct DilationTrace {
  DilationRecord* record = nullptr;        // is written; null: nothing is
  const DilationRecord* before = nullptr;  // of the same bones, skin, layer and options
  // #muscles: which of `before` it is, with the same sections; -1: it grows anew. A mirror image is
  // held where its partner is. Empty: none is.
  std::span<const int> held{};

  bool holds(std::size_t muscle) const { return !held.empty() && held[muscle] >= 0; }
  // As for pack_muscles, with those that are held as their own partners, but for mirror images:
  // what becomes of their sections is given.
  std::vector<int> with_held(std::span<const int> partners) const {
    std::vector<int> out(partners.begin(), partners.end());
    for (std::size_t m = 0; m < out.size(); ++m)
      if (out[m] < 0 && holds(m)) out[m] = int(m);
    return out;
  }
  // Calls f(slice, the same slice of `before`) for all slices that are held.
  template <class Function>
  void for_held(std::span<const std::size_t> muscle_begin, const Function& f) const {
    for (std::size_t m = 0; m < held.size(); ++m) {
      if (held[m] < 0) continue;
      const std::size_t from = before->muscle_begin[std::size_t(held[m])];
      for (std::size_t k = muscle_begin[m]; k < muscle_begin[m + 1]; ++k)
        f(k, from + k - muscle_begin[m]);
    }
  }
};

}  // namespace ecorche::inline v1
