/// Names: of the methods, as users type them, and of the message constants, as files and logs show them.
#include <stdexcept>

#include "collision_node/impact/pair_method.h"

namespace collision_node::impact {

MethodName parseMethod(const std::string& name) {
  if (name == "certified") return MethodName::kCertified;
  if (name == "paper_a") return MethodName::kPaperA;
  if (name == "paper_b") return MethodName::kPaperB;
  throw std::invalid_argument("method: \"" + name + "\" is unknown; use certified, paper_a or paper_b");
}

std::unique_ptr<PairMethod> makeMethod(MethodName name, const geometry::Body& a, const geometry::Body& b,
                                       const PairOptions& options) {
  switch (name) {
    case MethodName::kCertified:
      return makeCertified(a, b, options);
    case MethodName::kPaperA:
      return makePaperA(a, b, options);
    case MethodName::kPaperB:
      return makePaperB(a, b, options);
  }
  throw std::invalid_argument("method: no such MethodName");
}

// A switch without default lets the compiler name the constant that is missing; the return behind it is for
// values that are no constant at all.

const char* toString(Kind kind) {
  switch (kind) {
    case Kind::kImpact:
      return "IMPACT";
    case Kind::kSeparation:
      return "SEPARATION";
    case Kind::kInitialOverlap:
      return "INITIAL_OVERLAP";
  }
  return "INVALID";
}

const char* toString(Certificate certificate) {
  switch (certificate) {
    case Certificate::kConfirmed:
      return "CONFIRMED";
    case Certificate::kPossible:
      return "POSSIBLE";
    case Certificate::kUncertified:
      return "UNCERTIFIED";
  }
  return "INVALID";
}

const char* toString(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "NONE";
    case Reason::kPrecision:
      return "PRECISION";
    case Reason::kBudget:
      return "BUDGET";
    case Reason::kGrazing:
      return "GRAZING";
    case Reason::kGap:
      return "GAP";
    case Reason::kReset:
      return "RESET";
    case Reason::kStampGuessed:
      return "STAMP_GUESSED";
    case Reason::kAlias:
      return "ALIAS";
    case Reason::kTimeout:
      return "TIMEOUT";
    case Reason::kMethod:
      return "METHOD";
  }
  return "INVALID";
}

const char* toString(Feature feature) {
  switch (feature) {
    case Feature::kUnknown:
      return "UNKNOWN";
    case Feature::kVertex:
      return "VERTEX";
    case Feature::kEdge:
      return "EDGE";
    case Feature::kFace:
      return "FACE";
    case Feature::kSmooth:
      return "SMOOTH";
  }
  return "INVALID";
}

}  // namespace collision_node::impact
