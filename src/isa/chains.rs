//! Super-instructions: sequences that programs execute often, each with code of its own.
//!
//! A chain names the registers of its instructions, as source text does. Where a program has the same instructions on registers that
//! can be named so, what one instruction gives for another is not looked for in the register file, but is at hand. The file is written
//! behind each block of instructions, when none of them can fail any more: one that fails is left to the plain interpreter, which
//! executes the block once more and finds the registers as they were.

use super::effects::Effect;
use super::executable::Step;
use super::processor::{Flow, Processor};
use super::table::Opcode;

/// An instruction of a chain: which, and its registers' names.
struct Pattern {
    opcode: Opcode,
    names: &'static [&'static str],
    /// Whether the first of them is written.
    writes: bool,
}

/// A register that a chain has a name for: its place in the register file, and what it holds.
#[derive(Clone, Copy)]
struct Named {
    slot: u8,
    value: u32,
}

/// The values of an instruction's registers, by its fields.
#[inline(always)]
fn fields<const COUNT: usize>(values: [u32; COUNT]) -> [u32; 3] {
    std::array::from_fn(|field| values.get(field).copied().unwrap_or_default())
}

macro_rules! chains {
    ($($chain:ident: $({ $($opcode:ident $to:ident $($from:ident)*),* } $($branch:ident $($read:ident)*),*)+;)*) => {
        /// A sequence of instructions with code of its own.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Chain {
            /// Any one instruction.
            One,
            $($chain,)*
        }

        impl Chain {
            /// All of them with their instructions.
            const ALL: &[(Chain, &[Pattern])] = &[$((Chain::$chain, &[$(
                $(Pattern {
                    opcode: Opcode::$opcode,
                    names: &[stringify!($to) $(, stringify!($from))*],
                    writes: true,
                },)*
                $(Pattern { opcode: Opcode::$branch, names: &[$(stringify!($read)),*], writes: false },)*
            )+]),)*];
        }

        impl Processor<'_> {
            /// Executes the chain that begins some steps, the first of which is at an address, until an instruction of it does
            /// not lead to the next. Tells how many have led to the next, and where the one behind them leads.
            #[inline(always)]
            #[allow(unused_assignments, unused_mut, unused_variables, reason = "chains without blocks, branches or registers")]
            pub(super) fn execute_chain(&mut self, steps: &[Step], address: u32) -> (usize, Flow) {
                let Some(first) = steps.first() else { return (0, Flow::Next) };
                match first.chain {
                    $(Chain::$chain => {
                        const LENGTH: usize = [$($(Opcode::$opcode,)* $(Opcode::$branch,)*)+].len();
                        if let Some(steps) = steps.first_chunk::<LENGTH>() {
                            let mut done = 0;
                            // Where a name stands again it is the same register.
                            $(
                                $(
                                    let $to = self.named(steps[done].slots[0]);
                                    let mut field = 1;
                                    $(
                                        let $from = self.named(steps[done].slots[field]);
                                        field += 1;
                                    )*
                                    done += 1;
                                )*
                                $(
                                    let mut field = 0;
                                    $(
                                        let $read = self.named(steps[done].slots[field]);
                                        field += 1;
                                    )*
                                    done += 1;
                                )*
                            )+
                            done = 0;
                            $(
                                let begin = done;
                                $(
                                    let values = fields([$to.value $(, $from.value)*]);
                                    let constant = steps[done].constant as u32;
                                    let Effect::Gives(value) = self.effect(Opcode::$opcode, values, constant) else {
                                        return self.execute_plainly(steps, begin, address);
                                    };
                                    let $to = Named { value, ..$to };
                                    done += 1;
                                )*
                                $(self.registers[$to.slot as usize] = $to.value;)*
                                $(
                                    let values = fields([$($read.value),*]);
                                    let constant = steps[done].constant as u32;
                                    if let Effect::Leads(to) = self.effect(Opcode::$branch, values, constant) {
                                        return (done, Flow::To(to));
                                    }
                                    done += 1;
                                )*
                            )+
                            return (done, Flow::Next);
                        }
                    })*
                    Chain::One => {}
                }
                match self.execute(first, address) {
                    Flow::Next => (1, Flow::Next),
                    other => (0, other),
                }
            }
        }
    };
}

impl Processor<'_> {
    /// What is in a slot of the register file.
    #[inline(always)]
    fn named(&self, slot: u8) -> Named {
        Named { slot, value: self.registers[slot as usize] }
    }

    /// Executes steps one by one, from the one at a place on.
    #[cold]
    #[inline(never)]
    fn execute_plainly(&mut self, steps: &[Step], from: usize, address: u32) -> (usize, Flow) {
        for (done, step) in steps.iter().enumerate().skip(from) {
            match self.execute(step, address + done as u32) {
                Flow::Next => {}
                other => return (done, other),
            }
        }
        (steps.len(), Flow::Next)
    }
}

// What the standard programs execute most often. Names are those of their source where it helps; any register can have any of them.
// A block may not store: when it is executed again, it would load what it has stored.
chains! {
    GridStart: { Lw a zero } Beq a zero { Mov limit t_max, Lw endless zero, Lw unity zero, Fabs a o_x, Fabs b o_y, Fabs c o_z,
        Fmax a a b, Fmax a a c, Lw b zero } Fble a b;
    Planes: { Lw a zero, Lw b zero, Add b a b, Lw a a, Lw b b, Fsub a a stray, Fadd b b stray, Fdiv per_d unity d, Fabs c per_d }
        Fblt c endless;
    Between: { Fsub a a o, Fmul a a per_d, Fsub b b o, Fmul b b per_d, Fmin c a b, Fmax b a b, Fmax enters c enters,
        Fmin leaves b leaves };
    Begin: { Fmul a d enters, Fadd a o a, Lw b zero, Fsub a a b, Lw b zero, Fmul a a b, Ftoi a a, Max a a zero, Lw b zero, Addi b b,
        Min at a b, Mov t endless } Beq per_d zero { Lw a zero } Blt per_d zero { Addi a a, Li step } Jmp;
    PlaneT: { Lw a zero, Add a a at, Lw a a, Fsub a a o, Fmul t a per_d };
    Voxel: { Lw a zero, Mul a a at_z, Add a a at_y, Lw b zero, Mul a a b, Add a a at_x, Lw b zero, Add a a b, Lw list a,
        Lw list_end a } Beq list list_end;
    Polygon: { Lw polygon list };
    NextPolygon: { Addi list list } Bne list list_end, Bne stray zero, Fble t_x t_y, Fble t_y t_z, Jmp;
    Crossing: {} Fble t_x t_y, Fble t_y t_z, Jmp;
    NotY: {} Fble t_x t_z, Jmp;
    Cross: {} Fble limit t { Lw a zero } Beq at a
        { Add at at step, Lw a zero, Add a a at, Lw a a, Fsub a a o, Fmul t a per_d } Jmp;
    SlabsStart: { Shl a polygon, Shl b polygon, Sub a a b, Lw b zero, Add slab a b, Li near, Mov far t_max };
    Slab: { Lw a slab, Fadd b s margin, Fsub a a b, Fmul a a t, Lw b slab, Fsub c s margin, Fsub b b c, Fmul b b t,
        Fmin c a b, Fmax b a b, Fmax near c near, Fmin far b far } Fblt far near;
    TwoSlabs: { Lw a slab, Fadd b s margin, Fsub a a b, Fmul a a t, Lw b slab, Fsub c s margin, Fsub b b c, Fmul b b t,
        Fmin c a b, Fmax b a b, Fmax near c near, Fmin far b far,
        Lw a slab, Fadd b s2 margin, Fsub a a b, Fmul a a t2, Lw b slab, Fsub c s2 margin, Fsub b b c, Fmul b b t2,
        Fmin c a b, Fmax b a b, Fmax near c near, Fmin far b far };
    Plane: { Lw a zero, Add a a polygon, Lw record a, Lw a record, Lw b record, Lw c record, Fmul t a dx, Fmul f b dy,
        Fadd t t f, Fmul f c dz, Fadd t t f, Shl f t } Beq f zero;
    Meeting: { Fmul a a ox, Fmul b b oy, Fadd a a b, Fmul b c oz, Fadd a a b, Lw b record, Fsub a b a, Fdiv t a t, Flt ahead zero t,
        Fle b t limit, And ahead ahead b, Fmul a t dx, Fadd a ox a, Fmul b t dy, Fadd b oy b, Fmul c t dz, Fadd c oz c };
    Projection: { Lw left record, Andi u left, Shr left left, Addi left left, Li v } Beq u v, Blt v u;
    Projected: { Mov u b, Mov v c, Addi at_u record, Addi at_v record };
    Corners: { Lw s_u at_u, Lw s_v at_v, Fsub u0 u0 s_u, Fsub v0 v0 s_v, Lw u2 at_u, Lw v2 at_v, Fsub u2 u2 s_u, Fsub v2 v2 s_v };
    NextCorner: { Mov u1 u2, Mov v1 v2, Addi at_u at_u, Addi at_v at_v, Lw u2 at_u, Lw v2 at_v, Fsub u2 u2 s_u, Fsub v2 v2 s_v };
    Beside: { Fmin a u1 u2, Fmin a a zero, Flt outside u0 a, Fmax a u1 u2, Fmax a a zero, Flt b a u0, Or outside outside b,
        Fmin a v1 v2, Fmin a a zero, Flt b v0 a, Or outside outside b, Fmax a v1 v2, Fmax a a zero, Flt b a v0,
        Or outside outside b };
    Determinants: { Fmul c u1 v2, Fmul a v1 u2, Fsub c c a, Fmul alpha u0 v2, Fmul a v0 u2, Fsub alpha alpha a, Fdiv alpha alpha c,
        Fmul beta u1 v0, Fmul a v1 u0, Fsub beta beta a, Fdiv beta beta c };
    Inside: { Fle within zero alpha, Fle b zero beta, And within within b, And within within ahead, Fadd a alpha beta, Lw b zero,
        Fle b a b, And within within b, Fabs a c, Lw b zero, Fle b b a, And within within b } Bltu outside within
        { Addi left left } Beq left zero, Bne ahead zero, Jmp;
    Copies: { Mov b a, Mov d c };
    Equal: {} Beq a b;
    Jump: {} Jmp;
}

impl Chain {
    /// The longest with which some steps begin.
    pub fn of(steps: &[Step]) -> Chain {
        let longest =
            Chain::ALL.iter().filter(|(_, patterns)| fits(patterns, steps)).max_by_key(|(_, patterns)| patterns.len());
        longest.map_or(Chain::One, |&(chain, _)| chain)
    }
}

/// Whether steps begin with a chain's instructions, and the registers can be named so: each name is one register, and one that is
/// written has no other name.
fn fits(patterns: &[Pattern], steps: &[Step]) -> bool {
    let pairs = || patterns.iter().zip(steps);
    if patterns.len() > steps.len() || pairs().any(|(pattern, step)| pattern.opcode != step.opcode) {
        return false;
    }
    let named: Vec<(&str, u8)> =
        pairs().flat_map(|(pattern, step)| pattern.names.iter().copied().zip(step.slots)).collect();
    let is_written = |name: &str| patterns.iter().any(|pattern| pattern.writes && pattern.names[0] == name);
    let agree = |&(name, slot): &(&str, u8), &(other, place): &(&str, u8)| {
        (name != other || slot == place) && (slot != place || name == other || !is_written(name))
    };
    named.iter().all(|one| named.iter().all(|other| agree(one, other)))
}

#[cfg(test)]
mod tests;
