# Lets the rules behind it name a table's columns: at("cells"). Points that failed are left out.
BEGIN { FS = ","; OFS = "," }
FNR == 1 { split("", column); for (i = 1; i <= NF; i++) column[$i] = i; next }
"error" in column && at("error") != "" { next }
function at(name) { return $(column[name]) }
