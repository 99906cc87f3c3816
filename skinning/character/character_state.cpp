#include "skinning/character/character_state.h"

namespace ecorche::inline v1 {

CharacterState::CharacterState(const CharacterModel& model) {
  const std::size_t size = 4 * std::size_t(model.binding.vertex_count);
  skin.positions.resize(size);
  skin.normals.resize(size);
}

}  // namespace ecorche::inline v1
