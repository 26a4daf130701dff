// faces.glsl - what both stages of a surface over faces know (spherical/faces.c): where vertices are on the charts, and
// seams.
//
// Places are samples of the finest level from a chart's first one, whole numbers. A vertex on a side belongs to several
// charts: all of them work it out by the formulas of the same one, that of the lowest number, so that it is the same float.
//
// surface[0]   sine and cosine of the viewer's latitude; 1 / cells of a chart along a side; what counts of the eye's height
//              for distances, lengths on the unit sphere
// surface[1]   x: mean length of a cell there; y, z: reference height that heights are told by in two parts, metres above z_base:
//              the eye's, or the highest ground's below it; w: that above the eye
// surface[2]   x: share of a level's range from which on it passes over; y: 1 / share in which; z: 0: edges of levels
//              do not meet; w: of levels on the data's mesh from_pole,
// surface[3]   x: 1 / range of the finest level; y: edge; z: 8 sag; w: bends (tc_faces_range()); of blocks chosen by their error
//              x: 1 / range of the finest normals; y, z: as x, y of surface[2]
// whole[0]     x: cells of a chart along a side; y: shift of the finest level that has samples; z: of the coarsest
// layer[3 l]   of a level of a chart: its chart, its shift from the finest level, 1 / range (0: of the coarsest), the chart's
//              last layer that is up to date; [3 l + 1] the viewer's place in its samples from the window's first
// FACE(k)      chart k's vectors, the first ones read by chart_*.glsl; the last one: x, y: the viewer from its nearest sample
//              on the chart, z, w: the same in chart coordinates
// PLACES(k)    likewise integers; the last four: of each side x: chart + (m + 8) 2^(8 + 4 k), y, z: dx, dy; w of the first two:
//              that sample
#define FACE(chart) (4 + 5 * (chart))
#define PLACES(chart) (1 + 5 * (chart))

// Sine and cosine of angles up to 2, by their series: drivers' may be off by more than a vertex may be.
vec2 sine_cosine(float x)
{
    float q = x * x;
    float s = 1.0 - q / 156.0 * (1.0 - q / 210.0);
    s = 1.0 - q / 42.0 * (1.0 - q / 72.0 * (1.0 - q / 110.0 * s));
    s = x * (1.0 - q / 6.0 * (1.0 - q / 20.0 * s));
    float c = 1.0 - q / 132.0 * (1.0 - q / 182.0 * (1.0 - q / 240.0));
    c = 1.0 - q / 30.0 * (1.0 - q / 56.0 * (1.0 - q / 90.0 * c));
    c = 1.0 - 0.5 * q * (1.0 - q / 12.0 * c);
    return vec2(s, c);
}

// The chart of the lowest number that has a place, and where it has it.
void settle_chart(inout int chart, inout ivec2 at)
{
#ifndef UNSETTLED // for tests, which look whether they find what that does
    int cells = whole[0].x;
    for (int times = 0; times < 3; times++) {
        bvec4 on = bvec4(at.x == 0, at.x == cells, at.y == 0, at.y == cells);
        if (!any(on))
            return;
        int lowest = chart;
        ivec2 there = at;
        for (int side = 0; side < 4; side++) {
            ivec4 seam = whole[PLACES(chart) + 1 + side];
            int other = seam.x & 255;
            if (!on[side] || other >= lowest)
                continue;
            ivec4 m = ((ivec4(seam.x) >> ivec4(8, 12, 16, 20)) & 15) - 8;
            lowest = other;
            there = ivec2(m.x * at.x + m.y * at.y, m.z * at.x + m.w * at.y) + seam.yz;
        }
        if (lowest == chart)
            return;
        chart = lowest;
        at = there;
    }
#endif
}
