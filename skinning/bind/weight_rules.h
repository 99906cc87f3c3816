// Rules by which skin departs from the bone beneath it: it turns gradually along limbs, slides
// along upper arm and thigh and over the shoulder blade, and goes with the jaw below the mouth.
// Private to the room.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/bind/skin_depth.h"
#include "skinning/bind/skin_weights.h"

namespace ecorche::inline v1 {

// The upper incisors hang before the lower ones, so that the lower lip lies nearest to the skull,
// and the mouth's walls lie before both. Skin before the jaw and below where the lips meet is the
// jaw's where `depth` has found the skull or nothing; what has found nothing above them is the
// skull's. Precondition: the rest pose is upright, facing +z.
void part_lips(const Anatomy& anatomy, const TriMesh& skin, SkinDepth& depth);

// Upper arm and thigh: the weight of the shoulder (hip) is split between the joint and a frame
// without its axial rotation, all of it at the shoulder and none at the elbow. Forearm: the weight
// of ulna and radius passes from one to the other along its length. New frames are appended to
// `twists`; rows then refer to frames (#joints + k). `painted`: vertices whose forearm stays as it
// is.
void spread_twist(const Skeleton& skeleton, const TriMesh& skin, std::span<const int> painted,
                  std::vector<WeightRow>& rows, std::vector<TwistFrame>& twists);

// Upper arm: where the skin is more of the arm than of the armpit, what joints above the shoulder
// hold of it is moved to slide frames. A raised arm's skin is drawn towards the trunk along the arm
// and stays about its bone; were it drawn across as well, the arm's flesh would lie beside its
// bone. Appends the frames to tables.slides; rows then refer to frames (tables.first_slide() + k).
// Precondition: tables have origins and all twists, rows no pairs.
void let_arm_skin_slide(const Skeleton& skeleton, const TriMesh& skin, FrameTables& tables,
                        std::vector<WeightRow>& rows);

// Thigh: from its upper third on, most of what joints of no leg hold of its skin goes to the hip.
// Where flesh is thick a diffusion leaves them a quarter of it there, and flesh of a raised thigh
// would lag behind the femur.
void release_thigh(const Skeleton& skeleton, const TriMesh& skin, std::vector<WeightRow>& rows);

// Thigh: a part of what the hip holds is moved to a slide frame that the knee carries. A bent knee
// draws skin and quadriceps down along the femur, the more the nearer to the knee, and little
// behind. Else as let_arm_skin_slide().
void let_thigh_skin_slide(const Skeleton& skeleton, const TriMesh& skin, FrameTables& tables,
                          std::vector<WeightRow>& rows);

// Away from the acromion most of the skin over the shoulder blade stays with the ribs while the
// blade slides beneath it (30 to 70 mm by upright tomography, 10.3390/s22176502).
void let_scapula_glide(const Skeleton& skeleton, const TriMesh& skin, std::vector<WeightRow>& rows);

// Pairs of joint and twist frames that both move some vertex and turn much against each other, with
// weight 2 w_a w_b for every vertex; see blend_tables.h. Sorts the rows by frame and appends their
// pairs (tables.first_pair() + k). Far from the hinge the weight fades: no bone pushes the skin of
// the groin out to the full circle. About joints of the girdle they count less, at any distance:
// the armpit's web is drawn straighter.
std::vector<FramePair> add_frame_pairs(const Skeleton& skeleton, const TriMesh& skin,
                                       const FrameTables& tables, std::vector<WeightRow>& rows);

}  // namespace ecorche::inline v1
