// The effect "sun": lunar soil under sunlight, as a mix of Lommel-Seeliger and Lambert that follows the phase angle (after McEwen
// 1991, "Photometric functions for photoclinometry and other applications"; the mix is fitted as the cube of the lit fraction).
uniform vec3 towardsSun;  // unit, body axes
uniform float ambient;    // fraction of full light that the night side gets

// Odd in the sun's height over the surface: below 0 where the sun is below it. Interpolated over a triangle, its zero is where the
// shade begins; cut off at the vertices already, shade would end in teeth along the triangles' sides.
float signedSunlight(vec3 normal, vec3 towardsEye) {
  float incidence = dot(normal, towardsSun);
  float emergence = max(dot(normal, towardsEye), 0.0);
  float lit = 0.5 + 0.5 * dot(towardsSun, towardsEye);
  float lommelSeeliger = 2.0 * incidence / max(abs(incidence) + emergence, 1e-4);
  float light = mix(incidence, lommelSeeliger, lit * lit * lit);
  // Seen at a grazing angle soil shines up to twice as bright: a soft shoulder keeps that on the display's scale. 1 stays 1.
  return 1.5 * light / (1.0 + 0.5 * abs(light));
}

float lightOf(float signedLight) { return max(signedLight, 0.0) + ambient; }
