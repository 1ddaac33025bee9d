/// The question this package answers, as one interface: when and where do two links touch on one piece of
/// time?
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "collision_node/geometry/types.h"
#include "collision_node/motion/rigid_motion.h"

namespace collision_node::geometry {
class Body;
}

namespace collision_node::impact {

using geometry::Pose;
using geometry::Vec3;
using motion::Nanoseconds;

// Numeric values are those of Impact.msg and ImpactSide.msg, for ever.
enum class Kind : std::uint8_t { kImpact = 0, kSeparation = 1, kInitialOverlap = 2 };
enum class Certificate : std::uint8_t { kConfirmed = 0, kPossible = 1, kUncertified = 2 };
enum class Reason : std::uint8_t {
  kNone = 0,
  kPrecision = 1,
  kBudget = 2,
  kGrazing = 3,
  kGap = 4,
  kReset = 5,
  kStampGuessed = 6,
  kAlias = 7,
  kTimeout = 8,
  kMethod = 9
};
enum class Feature : std::uint8_t { kUnknown = 0, kVertex = 1, kEdge = 2, kFace = 3, kSmooth = 4 };

/// The time between two consecutive stamps of either track, and both objects' motion on it.
/// Owns (start, end]; a pair's first piece owns its start too.
struct Piece {
  Nanoseconds start_ns = 0;
  Nanoseconds end_ns = 0;
  motion::RigidMotion a;  ///< each from its own track's two stamps, never re-interpolated
  motion::RigidMotion b;
  /// [m] How far a point of A and one of B may be from where the motions put them, together. What is proved
  /// holds for all such true motions; facts of a contact (features, normal) are the model's. Certified solver
  /// only.
  double tube = 0.0;
};

/// How far a piece is looked at.
enum class Scope : std::uint8_t {
  kWholePiece,    ///< all changes of contact
  kFirstContact,  ///< up to the first event; what comes after it is not looked at
};

struct PairOptions {
  double time_precision = 1e-9;      ///< [s] where refinement of a bracket may stop
  double distance_precision = 1e-6;  ///< [m] where refinement of the position ball may stop
  double contact_distance = 0.0;     ///< [m] >= 0; touching means distance <= this
  /// Node tests one piece may cost; met, as some 400 MB of halved times are: POSSIBLE, reason BUDGET.
  std::uint64_t node_budget = 4000000;
  Scope scope = Scope::kWholePiece;  ///< streams need kWholePiece
};

/// One side of a contact, in the frame of the object (not of the link).
struct Side {
  int shape = -1;  ///< index into the body's shapes, -1 unknown
  Feature feature = Feature::kUnknown;
  int triangle = -1;                                      ///< index into the mesh's triangles, -1 none
  Vec3 point = Vec3::Zero();                              ///< witness [m]
  Pose pose;                                              ///< world <- object at toi_lower
  Nanoseconds sample_before_ns = 0, sample_after_ns = 0;  ///< this object's segment; 0 for a fixed object
};

/// One change of contact between two links: the fields of Impact.msg that geometry and motion decide.
struct PairEvent {
  Kind kind = Kind::kImpact;
  Certificate certificate = Certificate::kUncertified;
  Reason reason = Reason::kNone;
  Nanoseconds interval_start_ns = 0, interval_end_ns = 0;  ///< the piece that holds toi_lower
  double toi_lower = 0.0, toi_upper = 0.0;                 ///< [s] from interval_start_ns
  Vec3 position = Vec3::Zero();                            ///< world [m]
  double position_error = 0.0;                             ///< [m]
  bool multiple = false;
  Vec3 normal = Vec3::Zero();             ///< unit, from a to b, world; NaN if undefined
  double normal_error = 0.0;              ///< [rad]
  Vec3 relative_velocity = Vec3::Zero();  ///< v_b - v_a of the material points, world [m/s]
  double closing_speed = 0.0;             ///< [m/s] -(v_b - v_a).normal
  Side a, b;
};

/// What one piece cost and said, for `~stats`.
enum class Answer : std::uint8_t { kCulled = 0, kClear = 1, kImpact = 2, kUndecided = 3 };
struct PieceOutcome {
  Answer answer = Answer::kClear;
  std::uint64_t node_tests = 0;
  std::uint64_t subdivisions = 0;
  bool budget_met = false;
};

/// What is known of a pair at the end of its last piece. A new object is a pair never seen.
struct PairState {
  enum class Phase : std::uint8_t { kNew, kApart, kTouching, kUndecided };
  Phase phase = Phase::kNew;
  bool was_touching = false;  ///< kUndecided: the bracket opened from contact (else from apart)
  bool published =
      false;          ///< kUndecided for so long that the bracket was published; it holds nothing up any more
  PairEvent pending;  ///< kUndecided: the bracket being searched, toi_lower is set
  double pending_spin = 0.0;   ///< kUndecided: the largest sum of both spins since then [rad/s]
  double pending_speed = 0.0;  ///< kUndecided: the largest speed of any point since the bracket opened [m/s]
  PairEvent contact;           ///< kTouching (and kUndecided from contact): the event that opened the contact
  Piece last_piece;            ///< the last piece advanced over
};

/// A way to answer. Implementations are immutable after construction and safe to share between threads;
/// all state is in PairState and the events.
class PairMethod {
 public:
  virtual ~PairMethod() = default;

  /// Appends the changes of contact on `piece`, in time order, and brings `state` to the piece's end.
  /// Pieces of one pair adjoin: piece.start_ns equals the previous piece.end_ns, else call interrupt() first.
  /// Never throws for numeric reasons.
  virtual PieceOutcome advance(const Piece& piece, PairState& state,
                               std::vector<PairEvent>& events) const = 0;

  /// True when proofs take Piece::tube into account.
  virtual bool knowsTubes() const { return false; }

  /// Nothing more will come (end of bag, flush): publishes an open undecided bracket as POSSIBLE, toi_upper
  /// at the last piece's end, unless it was published before. An open contact stays open and makes no event.
  virtual void finish(PairState& state, std::vector<PairEvent>& events) const = 0;

  /// Nothing is swept through a gap, teleport, timeout or reset: finish(), then for an open contact one
  /// UNCERTIFIED SEPARATION with `reason`, from the last instant at which contact is known (toi_lower) to the
  /// last piece's end. The state is new afterwards.
  virtual void interrupt(PairState& state, Reason reason, std::vector<PairEvent>& events) const = 0;
};

/// The certified solver. Guarantees: docs/solver.md, first section. The bodies must outlive the method.
/// Options out of range throw std::invalid_argument here, a tube below 0 or a piece that ends before it
/// begins in advance().
std::unique_ptr<PairMethod> makeCertified(const geometry::Body& a, const geometry::Body& b,
                                          const PairOptions& options);

/// The paper's method A (straight paths) or B (curved paths); always UNCERTIFIED, reason METHOD.
std::unique_ptr<PairMethod> makePaperA(const geometry::Body& a, const geometry::Body& b,
                                       const PairOptions& options);
std::unique_ptr<PairMethod> makePaperB(const geometry::Body& a, const geometry::Body& b,
                                       const PairOptions& options);

/// Parses "certified", "paper_a", "paper_b"; throws std::invalid_argument that lists them.
enum class MethodName { kCertified, kPaperA, kPaperB };
MethodName parseMethod(const std::string& name);
std::unique_ptr<PairMethod> makeMethod(MethodName name, const geometry::Body& a, const geometry::Body& b,
                                       const PairOptions& options);

const char* toString(Kind kind);
const char* toString(Certificate certificate);
const char* toString(Reason reason);
const char* toString(Feature feature);

}  // namespace collision_node::impact
