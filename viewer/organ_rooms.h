// Rooms of a body where organs lie: of the skull, the chest and the belly. The anatomy has no
// organs; a cut shows the room that bones and muscles leave for them, under its name.
#pragma once

#include <cstdint>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/muscle_surface.h"
#include "viewer/draw_list.h"

namespace ecorche {

struct OrganRoomName {
  const char *name, *label;
};
inline constexpr OrganRoomName kOrganRooms[] = {{"skull_room", "skull: room of the brain"},
                                                {"chest_room", "chest: room of lungs and heart"},
                                                {"belly_room", "belly: room of the bowels"}};

struct OrganRoom {
  int which = 0;                        // of kOrganRooms
  std::vector<Vec3f> rest{};            // world
  std::vector<Triangle32> triangles{};  // closed, counter-clockwise seen from outside
  struct Hold {
    int lower = 0, upper = 0;  // joints
    float share = 0;           // of the upper
  };
  std::vector<Hold> holds{};  // #rest
};

// At rest, without those whose walls the anatomy lacks. `surface`: of its muscles.
//
// The skull's: rays from its middle to the bone's surface, less the vault's thickness, for the bone
// has no inner surface. Those of the trunk: at every height, rays from between spine and front wall
// to ribs, spine, hip bones and muscles; gaps narrower than a rib's width are bridged. A dome from
// the chest's lower rim up to the tenth vertebra of the chest parts them (the midriff after
// breathing out); the belly ends flat at the height of the tail bone.
std::vector<OrganRoom> find_organ_rooms(const Anatomy& anatomy, const MuscleSurface& surface);

// In a pose, with its part number and colour.
DrawMesh posed_room(const OrganRoom& room, const std::vector<Vec3>& joint_rest,
                    const PosedAnatomy& posed);

std::vector<DrawMesh> posed_rooms(const std::vector<OrganRoom>& rooms,
                                  const std::vector<Vec3>& joint_rest, const PosedAnatomy& posed);

// m^3
double volume_of(const OrganRoom& room);

}  // namespace ecorche
