// Nodes that pass sheaves.
#pragma once

#include "types.hpp"

namespace baseline {

// Let nodes that are close to a sheave pass it: how many did, or -1 where a run has come to its end.
I64 pass_nodes(char* const* bases);

}  // namespace baseline
