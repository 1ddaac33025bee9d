/// Does a polygon with corners on straight lines hold the origin at one rational time? Decided exactly.
#pragma once

#include "collision_node/impact/linear/moving_polygon.h"

namespace collision_node::impact {

/// True only if the exact corners, (later - weight) start + weight end over `later`, hold the origin in their
/// convex hull. Needs whole numbers 0 <= weight <= later. False when they do not, or when a product
/// underflowed. The corners must be exact sums of two doubles in convex position (three, or the four of a
/// parallelogram).
bool holdsOriginAt(const MovingPolygon<DoubleDouble>& polygon, double weight, double later);

/// The fraction weight / later with the smallest denominator in [low, high], 0 <= low <= high <= 1. A
/// proposal: rounding may put it slightly outside.
void simplestFraction(double low, double high, double* weight, double* later);

}  // namespace collision_node::impact
