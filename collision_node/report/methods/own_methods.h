/// The methods of the paper, and those it argues against, each as it is described. What had to be read
/// charitably: docs/paper_methods.md and docs/report.md.
#pragma once

#include "collision_node/report/contestant.h"

namespace collision_node::report {

/// Static tests at the piece's two stamps, and no others.
ContestantPtr makeStamps(const QuerySet& set);

/// Static tests at the ends of `steps` equal parts of the piece; the time is that of the first one in
/// contact.
ContestantPtr makeSubdivision(const QuerySet& set, int steps);

/// Four-dimensional intersection (S. Cameron, Collision Detection by Four-Dimensional Intersection Testing,
/// 1990): the volumes that both bodies sweep during the piece must meet; then `samples` static tests in the
/// time in which their bounding spheres do.
ContestantPtr makeSweptVolumes(const QuerySet& set, int samples);

/// A line-of-sight test: from where the smaller body stands at the first stamp, along its velocity there,
/// against the other frozen where it stands at that stamp.
ContestantPtr makeLineOfSight(const QuerySet& set);

/// The paper's methods (impact/paper_methods.h) as they stand.
ContestantPtr makePaperA(const QuerySet& set);
ContestantPtr makePaperB(const QuerySet& set);

/// The same with "sampling near S" for a B whose shape is not neglected: 64 static tests of the whole body
/// round the instant at which its particle reaches S, as far as the body itself reaches; the first in contact
/// is the time.
ContestantPtr makePaperASampled(const QuerySet& set);
ContestantPtr makePaperBSampled(const QuerySet& set);

}  // namespace collision_node::report
