// Stages 1 to 3 in order: edges, chains, circles, identification.
#pragma once

#include "pipeline/parameters.hpp"
#include "pipeline/result.hpp"
#include "pipeline/workspace.hpp"

namespace berth {

/// Edge pixels of the frame (stage 1a).
void search_edges(const Parameters& parameters, const ImageView& image, Workspace& work,
                  FrameResult& result);

/// Edge chains (stage 1b).
void link_chains(Workspace& work, FrameResult& result);

/// Rings, best-covered first (stage 2).
void search_rings(Workspace& work, FrameResult& result);

/// Is ring number `ring` the target's (stage 3, with the reference values of stage 4)?
bool identify_ring(const Parameters& parameters, const ImageView& image, int ring, Workspace& work,
                   FrameResult& result);

}  // namespace berth
