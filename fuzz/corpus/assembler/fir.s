; A FIR filter: y[n] = sum over k of tap[k] * x[n - k], a word out on X for every word in. It is never done: all words
; are one message, so what is kept in memory lasts from one to the next.
;
; sums[k] holds what the words before have put by for the output that is k words away. A new word adds to each sum and
; moves it one place nearer; sums[0] is then complete.

        .reg    sample  r1              ; x[n]
        .reg    k       r2
        .reg    product r3              ; tap[k] * x[n]
        .reg    sum     r4
        .reg    count   r5

TAPS = 4

        li      count, TAPS
next:   mov     sample, x
        li      k, 0
tap:    lw      product, [k + taps]
        fmul    product, product, sample
        lw      sum, [k + sums + 1]
        fadd    sum, product, sum
        sw      sum, [k + sums]
        addi    k, k, 1
        blt     k, count, tap
        lw      sum, [sums]
        mov     x, sum
        jmp     next

        .data
taps:   .float  0.5, 0.25, 0.125, 0.125
sums:   .space  TAPS + 1                ; the last stays 0
