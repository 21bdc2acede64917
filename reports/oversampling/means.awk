BEGIN { print "by,mode,oversampled,times_as_long,error_left" }
{ key = at("by") "," at("mode") }
!(key in count) { order[++keys] = key }
{ count[key]++; share[key] += at("oversampled"); long[key] += log(at("times_as_long")); left[key] += log(at("error_left")) }
END {
    for (i = 1; i <= keys; i++) {
        k = order[i]
        print k, sprintf("%.3f,%.2f,%.3f", share[k] / count[k], exp(long[k] / count[k]), exp(left[k] / count[k]))
    }
}
