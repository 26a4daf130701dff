// rings_ch06.glsl - the map transform as CH06 has it, to compare: absolute angles in float, from which the viewer's are
// taken off (equations 3 and 4), and from level 10 on approximations (11 and 14), blended in over one level.
//
// The sign of equation 3 and the factor cos(phi~) of equation 14 are mended; the reciprocal of sin(theta_v) is exact.
#define CH06

float rise(vec3 s);

vec2 map_lonlat(vec3 s, float w)
{
    float ct = surface[0].x, st = surface[0].y, c = 1.0 - s.z;
    float px = ct * s.x + st * c, pz = ct * c - st * s.x;
    vec2 far = vec2(atan(s.y, px), surface[3].x - acos(clamp(pz, -1.0, 1.0)));
    vec2 near = vec2(s.y / max(st, 1e-6), -s.x);
    return mix(far, near, clamp(w - 9.0, 0.0, 1.0));
}

vec2 map_cap(int chart, vec3 s, float w)
{
    vec2 d = map_lonlat(s, w);
    float theta = surface[3].x - d.y, t = chart == 1 ? theta : 3.14159265 - theta;
    float tv = chart == 1 ? surface[3].x : 3.14159265 - surface[3].x;
    vec4 k = surface[10 + chart];
    float from = k.z == 0.0 ? 2.0 * tan(0.5 * tv) : 0.0; // near a cap places are relative to the viewer
    vec2 p = 2.0 * tan(0.5 * t) * vec2(cos(d.x), sin(d.x)) - vec2(from, 0.0);
    return vec2(surface[0].z * p.x - surface[0].w * p.y, surface[0].w * p.x + surface[0].z * p.y);
}
