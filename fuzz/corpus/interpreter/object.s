pcs object
code
0103c000
00000000
data
3f800000
