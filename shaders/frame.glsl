// frame.glsl - what every stage of a frame knows; laid out as tc_frame_uniforms in common/render/frame_uniforms.h.
layout(std140, binding = 0) uniform Frame {
    mat4 view_projection;  // from positions relative to the eye
    vec4 surface[SURFACE_VECTORS];      // the surface's own
    vec4 layer[LAYER_VECTORS * 2 * LAYERS]; // the surface's own, of each layer: a level of a chart; then of imagery
    vec4 window[LAYERS];   // of each layer, samples: x, y: first, modulo twice the texture's size; z, w: last minus first
    vec4 eye;              // x: reference height, y: eye above it, metres above z_base; z, w: the same of what heights are told
                           // from: the eye, or the highest ground below it
    vec4 ray[3];           // from the eye to the frame's middle is [2], from there to its sides [0] right and [1] up
    vec4 sun;              // xyz: direction to the sun; w: strength
    vec4 dusk;             // at the eye: x: share of daylight, y: light that is there without the sun, z: how much is seen of stars
                           // above a plane; w: how much of a star's light goes in the air around a globe
    vec4 heights;          // ramp: x: sea level, y: 1 / depth of the sea, z: 1 / height of the land, w: height of the shore;
                           // of given colours z: 1 / relief, w: lowest height above the sea, or 1 / degrees, 0
    vec4 haze;             // rgb; w: near plane / distance of half haze
    vec4 zenith;           // rgb of the sky overhead
    vec4 lens;             // x, y: tangents a pixel; z, w: from the target's first to straight ahead
    vec4 pixel[3];         // view axes: right, up, forward
    vec4 beyond;           // x: depth where nothing is, in clip space; y: heights over the true ones; z, w: height of a sea that is given
                           // above z_base, and how far above it ground still is sea
    vec4 contours;         // x: 1 / metres between lines, y: number of the one at the eye, modulo 5, z: those metres; of heights as they
                           // are drawn
    vec4 around[5];        // what is around the map, of a flat one [0]: its west, south, east and north end from the eye; [1]: the sea from the eye
                           // and above z_base, the foot of walls above that, depth of the sea at the edge; [2]: how far the sea
                           // goes, 1 / the terrain's extent, how far it goes below the terrain, how far inner walls rise above it;
                           // [3]: rgb of walls, 1 / height above the foot; [4]: latitude of the eye, radians, and by metres north of it, true height that
                           // the ramp begins at, metres above the sea
    vec4 space[3];         // east, north and up of the eye, in axes that do not turn with it
    vec4 body[BODY_VECTORS]; // of a globe: body_*.glsl
    ivec4 whole[SURFACE_INTEGERS]; // the surface's own, integers
    ivec4 image_stack[CHARTS]; // of imagery: x: layer of shift 0; y, z: finest and coarsest shift
    vec4 image_scale[CHARTS];  // x, y: finest texels per unit of a place
};

// Heights that are interpolated are small where they are looked at: drivers have little more than half of a float's digits
// left of them where a triangle begins at the near plane and ends at a skyline, and what some interpolate for a sample is
// wrong by as large a share of it as distances change within a pixel. So they are told from near the eye, and where the sea
// is seen if they are off, from that once more.
#if defined(WATER) || defined(FLOOD)
#define AT_SEA
#endif
#ifdef FLOOD
#define SEA_LEVEL beyond.z // metres above z_base
#else
#define SEA_LEVEL heights.x
#endif
