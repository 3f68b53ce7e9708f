// Vectors of double-floats, one source for GLSL and C++: see double_float_operations.glsl, of which both forms, DoubleFloat of float and
// DoubleFloat3 of vec3, must stand before this. Sums run in the order of the axes, so that all who compute a length get the same.

FUNCTION DoubleFloat dotPair(DoubleFloat3 a, DoubleFloat3 b) {
  DoubleFloat3 products = multiplyPair(a, b);
  DoubleFloat xy = addPair(DoubleFloat(products.hi.x, products.lo.x), DoubleFloat(products.hi.y, products.lo.y));
  return addPair(xy, DoubleFloat(products.hi.z, products.lo.z));
}

FUNCTION DoubleFloat3 scalePair(DoubleFloat3 v, DoubleFloat factor) {
  return multiplyPair(v, DoubleFloat3(vec3(factor.hi), vec3(factor.lo)));
}

FUNCTION DoubleFloat lengthPair(DoubleFloat3 v) { return squareRootPair(dotPair(v, v)); }

FUNCTION DoubleFloat3 normalizePair(DoubleFloat3 v) { return scalePair(v, inverseSquareRootPair(dotPair(v, v))); }
