/// An event in which every field differs from its default and from the others.
#pragma once

#include <cmath>
#include <limits>

#include "collision_node/scene/engine.h"

namespace collision_node::test {

inline scene::EventSide sampleSide(const std::string& object, double shift) {
  scene::EventSide s;
  s.object = object;
  s.link = object + "_link";
  s.zone = object + "_zone";
  s.zone_certain = true;
  s.shape = 3;
  s.feature = impact::Feature::kEdge;
  s.triangle = 17;
  s.point = {shift + 0.1, shift + 0.2, shift + 0.3};
  s.pose = {{shift + 1, shift + 2, shift + 3}, geometry::Quat(0.5, 0.5, -0.5, 0.5)};
  s.sample_before_ns = 1'700'000'000'000'000'001;
  s.sample_after_ns = 1'700'000'000'033'333'335;
  return s;
}

inline scene::Event sampleEvent() {
  scene::Event e;
  e.epoch = 2;
  e.event_id = 12345678901;
  e.contact_id = 12345678902;
  e.stamp_ns = 1'700'000'000'012'345'678;
  e.kind = impact::Kind::kSeparation;
  e.certificate = impact::Certificate::kPossible;
  e.reason = impact::Reason::kGrazing;
  e.interval_start_ns = 1'700'000'000'000'000'003;
  e.interval_end_ns = 1'700'000'000'033'333'334;
  e.toi_lower = 0.1;
  e.toi_upper = 1.0 / 3.0;
  e.position = {1e-300, -2.5, 4503599627370497.5};
  e.position_error = 5e-324;
  e.multiple = true;
  e.normal = {0, 0.6, -0.8};
  e.normal_error = 1e-7;
  e.relative_velocity = {-2000.25, 7, 8};
  e.closing_speed = 1999.5;
  e.model_toi_lower = e.model_toi_upper = e.model_position_error = std::numeric_limits<double>::quiet_NaN();
  e.a = sampleSide("a", 0);
  e.b = sampleSide("b", 10);
  return e;
}

}  // namespace collision_node::test
