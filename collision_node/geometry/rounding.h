/// What every bound of this package says of a rounding.
#pragma once

namespace collision_node::geometry {

constexpr double kUnit = 0x1p-53;  ///< u: a sum, product, quotient or root is off by this share at most
/// Makes a computed norm, or a sum of a few terms of one sign, an upper bound: 64 roundings.
constexpr double kUp = 1.0 + 64.0 * kUnit;

}  // namespace collision_node::geometry
