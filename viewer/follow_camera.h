// Camera path that follows a moving figure smoothly and keeps the whole figure in the picture.
#pragma once

#include <span>
#include <vector>

#include "viewer/draw_list.h"

namespace ecorche {

struct FollowCamera {
  // s, standard deviation of the Gaussian filters of the figure's path and the camera's distance;
  // less: the picture is restless; more: the figure is smaller in quick motions
  double smoothing = 0.30;
  double lead = 0.25;       // m ahead of the figure, along the smoothed path
  float elevation = 0.07f;  // rad, of the eye seen from the figure
  float begin_azimuth = -1.05f,
        // rad, of the eye seen from the figure; 0 front, -pi/2 its right side
      end_azimuth = -1.5707963f;
  double turn_begin = 0, turn_end = 1;  // shares of the film between which the azimuth changes
  float fov_y = 0.42f;                  // rad
  float aspect = 16.0f / 9;             // width / height of the picture
  float margin = 0.07f;                 // share of half the picture that stays free at each edge
};

// Cameras of all frames. figures: for each frame the world points that have to be in view, at least
// one. Points of the ground keep the ground beneath a leaping figure in view.
std::vector<Camera> follow(std::span<const std::vector<Vec3f>> figures, double fps,
                           const FollowCamera& options = {});

}  // namespace ecorche
