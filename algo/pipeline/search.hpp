// Stages 1 to 3 in order: edges, chains, circles, identification. Each ends early where `budget` is
// spent.
#pragma once

#include "core/work.hpp"
#include "pipeline/parameters.hpp"
#include "pipeline/result.hpp"
#include "pipeline/workspace.hpp"

namespace berth {

/// Noise of the sensor, once a frame. False where `budget` does not afford it.
bool know_noise(const ImageView& image, FrameResult& result, Work& budget);

/// Edge pixels of the grid (stage 1a).
void search_edges(const Parameters& parameters, const ImageView& image, const SearchGrid& grid,
                  Workspace& work, FrameResult& result, Work& budget);

/// Edge chains (stage 1b).
void link_chains(Workspace& work, FrameResult& result, Work& budget);

/// Arcs, those that turn most first; returns how many of them are whole outlines (stage 2).
int cut_arcs(Workspace& work, FrameResult& result, Work& budget);

/// Rings from arcs begin..end - 1, best-covered first, after those found already (stage 2).
void rings_from_arcs(int begin, int end, Workspace& work, FrameResult& result, Work& budget);

/// Further rings where votes meet, best-covered first, after those found already (stage 2):
/// outlines that lie in pieces too short for arcs.
void rings_from_votes(Workspace& work, FrameResult& result, Work& budget);

/// Is the ring seen as this plate the target's (stage 3, with the reference values of stage 4)?
Identification identify_plate(const Parameters& parameters, const ImageView& image,
                              const PlatePose& plate, bool has_roll, FrameResult& result,
                              Work& budget);

/// Take the dot furthest from where the identified plate has it, beside the mean of all, as not
/// located. At least one is.
void drop_unlikeliest_dot(const Parameters& parameters, const Identification& id,
                          FrameResult& result);

}  // namespace berth
