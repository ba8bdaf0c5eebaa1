// Reads the result of the material pass at a pixel.
uniform sampler2D normal_map;
uniform sampler2D depth_map;

const int kind_sky = 0;
const int kind_ground = 1;
const int kind_surface = 2;

struct SurfacePoint {
  int kind;
  vec3 point;   // in the world
  vec3 normal;  // unit, to the eye
  float depth;  // along the view
  float code;  // encodes metalness and sheen, or translucency
};

// `ray` is the varying of ray.vert.glsl.
SurfacePoint surface_point(ivec2 pixel, vec3 ray) {
  SurfacePoint result;
  vec4 stored = texelFetch(normal_map, pixel, 0);
  result.code = stored.w;
  result.kind = stored.w == 0.0 ? kind_sky : (stored.w < 0.0 ? kind_ground : kind_surface);
  result.normal = stored.xyz;
  // The range of the depth buffer ends before the floor does.
  float of_ground = (frame.ground.x - frame.eye.y) / ray.y;
  float clip = 2.0 * texelFetch(depth_map, pixel, 0).r - 1.0;
  float of_surface = frame.projection[3][2] / (clip + frame.projection[2][2]);
  result.depth = result.kind == kind_ground ? of_ground : of_surface;
  result.point = frame.eye.xyz + ray * result.depth;
  return result;
}
