# The median of each command's times, and how much longer it took than the image without timing.
BEGIN { FS = ","; print "command,wall_s,user_s,against_untimed" }
FNR > 1 { if (!($2 in n)) order[++commands] = $2; n[$2]++; wall[$2, n[$2]] = $3; user[$2, n[$2]] = $4 }
function median(values, name,    i, j, low) {
    for (i = 1; i <= n[name]; i++) {
        low = 0; for (j = 1; j <= n[name]; j++) low += values[name, j] < values[name, i] || values[name, j] == values[name, i] && j < i
        if (low == int(n[name] / 2)) return values[name, i]
    }
}
END { for (i = 1; i <= commands; i++) { c = order[i]; print c, median(wall, c), median(user, c), sprintf("%.2f", median(wall, c) / median(wall, "untimed")) } }
