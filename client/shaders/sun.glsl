// The effect "sun": lunar soil under sunlight, as a mix of Lommel-Seeliger and Lambert that follows the phase angle (after McEwen
// 1991, "Photometric functions for photoclinometry and other applications"; the mix is fitted as the cube of the lit fraction).
uniform vec3 towardsSun;  // unit, body axes
uniform float ambient;    // fraction of full light that the night side gets

float litFraction(vec3 normal, vec3 towardsEye) {
  float incidence = max(dot(normal, towardsSun), 0.0);
  float emergence = max(dot(normal, towardsEye), 0.0);
  float lit = 0.5 + 0.5 * dot(towardsSun, towardsEye);
  float lommelSeeliger = 2.0 * incidence / max(incidence + emergence, 1e-4);
  float light = mix(incidence, lommelSeeliger, lit * lit * lit);
  // Seen at a grazing angle soil shines up to twice as bright: a soft shoulder keeps that on the display's scale. 1 stays 1.
  return 1.5 * light / (1.0 + 0.5 * light) + ambient;
}
