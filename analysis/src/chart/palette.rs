//! The colours of all charts: black on white, greys that differ in print, and the hues of families.

use plotters::style::RGBColor;

pub const GRID: RGBColor = RGBColor(235, 235, 235);
/// Forbidden regions, and samples whose torque is limited.
pub const FORBIDDEN: RGBColor = RGBColor(225, 225, 225);
/// Secondary curves, and hatching on which a black curve is visible.
pub const FAINT: RGBColor = RGBColor(150, 150, 150);

/// Regions of a map, from the second best to the worst; the best is white.
pub const REGIONS: [RGBColor; 3] =
    [RGBColor(214, 214, 214), RGBColor(160, 160, 160), RGBColor(96, 96, 96)];

/// Families of methods: black, the colours of Okabe and Ito for colour-blind readers without yellow, which is
/// hard to see on white, and grey. Each has its own form, too.
pub const FAMILIES: [RGBColor; 8] = [
    RGBColor(0, 0, 0),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(110, 110, 110),
];
