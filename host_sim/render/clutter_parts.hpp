// The single parts of a payload's structure.
#pragma once

#include "host_sim/render/clutter.hpp"

namespace berth::host {

/// Where and with what a part is drawn.
struct Workbench {
  const PayloadPlane& plane;
  Painter& painter;
  Random& random;
  ClutterStyle style;

  /// A grey between two multiples of the style's level.
  Paint grey(double low, double high) const;

  /// The style's direction or the one across it, now and then any.
  double direction() const;
};

void draw_panel(const Workbench& bench, const Place& place, double size_mm);
void draw_foil(const Workbench& bench, const Place& place, double size_mm);
void draw_ring(const Workbench& bench, const Place& place, double radius_mm);
void draw_disc(const Workbench& bench, const Place& place, double radius_mm);
void draw_hole(const Workbench& bench, const Place& place, double radius_mm);
void draw_machined_circles(const Workbench& bench, const Place& place, double radius_mm);
void draw_bar(const Workbench& bench, const Place& place, double length_mm);
void draw_bolt(const Workbench& bench, const Place& place, double radius_mm);
void draw_bolt_row(const Workbench& bench, const Place& place, double pitch_mm);
void draw_bolt_circle(const Workbench& bench, const Place& place, double radius_mm);
void draw_cable(const Workbench& bench, const Place& place, double length_mm);
void draw_grille(const Workbench& bench, const Place& place, double size_mm);
void draw_reflection(const Workbench& bench, const Place& place, double size_mm);

}  // namespace berth::host
