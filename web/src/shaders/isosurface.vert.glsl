// A volume's box; the fragments send the rays.
in vec3 position;  // index coordinates
uniform mat4 indexToClip;

void main() { gl_Position = indexToClip * vec4(position, 1.0); }
