# Exponents of growth: slopes of least squares lines through the logarithms, over all sizes and over the last three.
BEGIN { FS = ","; print "what,from_polygons,exponent" }
FNR > 1 { polygons[++n] = $1; voxels[n] = $3; cost[n] = $6 }
function exponent(values, from,    i, x, y, count, sx, sy, sxx, sxy) {
    for (i = from; i <= n; i++) { x = log(polygons[i]); y = log(values[i]); count++; sx += x; sy += y; sxx += x * x; sxy += x * y }
    return sprintf("%.3f", (count * sxy - sx * sy) / (count * sxx - sx * sx))
}
END {
    print "voxels", polygons[1], exponent(voxels, 1); print "cost", polygons[1], exponent(cost, 1)
    print "voxels", polygons[n - 2], exponent(voxels, n - 2); print "cost", polygons[n - 2], exponent(cost, n - 2)
}
