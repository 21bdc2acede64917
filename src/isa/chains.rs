//! Super-instructions: sequences that programs execute often, each with code of its own, so that no instruction of it is looked
//! up by itself.

use super::executable::Step;
use super::processor::Processor;
use super::table::Opcode;

macro_rules! chains {
    ($($name:ident: $($opcode:ident)+;)*) => {
        /// A sequence of instructions with code of its own.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Chain {
            /// Any one instruction.
            One,
            $($name,)*
        }

        impl Chain {
            /// All of them with their instructions. None is a branch or an end.
            const ALL: &[(Chain, &[Opcode])] = &[$((Chain::$name, &[$(Opcode::$opcode),+]),)*];
        }

        impl Processor<'_> {
            /// Executes the chain that begins some steps. Tells how many have been executed; the first of the others, if they
            /// are fewer than the chain has, has failed.
            #[inline(always)]
            pub(super) fn compute_chain(&mut self, steps: &[Step]) -> Result<usize, usize> {
                let Some(first) = steps.first() else { return Ok(0) };
                match first.chain {
                    $(Chain::$name => {
                        const LENGTH: usize = [$(Opcode::$opcode),+].len();
                        if let Some(steps) = steps.first_chunk::<LENGTH>() {
                            let mut done = 0;
                            $(
                                if !self.compute(Opcode::$opcode, &steps[done]) {
                                    return Err(done);
                                }
                                done += 1;
                            )+
                            return Ok(done);
                        }
                    })*
                    Chain::One => {}
                }
                if self.compute(first.opcode, first) { Ok(1) } else { Err(0) }
            }
        }
    };
}

// Those of the standard programs, the loop of each kernel first.
chains! {
    Slab: Lw Fadd Fsub Fmul Lw Fsub Fsub Fmul Fmin Fmax Fmax Fmin;
    SlabsStart: Shl Shl Sub Lw Add Li Mov;
    Voxel: Lw Mul Add Add Lw Mul Add Lw Add;
    Cross: Add Lw Add Lw Fsub Fmul;
    Plane: Lw Add Lw Fsub Fmul;
    Parallel: Lw Add Lw Lw Lw Lw Fmul Fmul Fadd Fmul Fadd Shl;
    Meeting: Fmul Fmul Fadd Fmul Fadd Lw Fsub Fdiv Flt Fle And Fmul Fadd Fmul Fadd Fmul Fadd;
    Corner: Lw Lw Fsub Fsub;
    NextCorner: Mov Mov Addi Addi Lw Lw Fsub Fsub;
    Beside: Fmin Fmin Flt Fmax Fmax Flt Or;
    Beyond: Fmin Fmin Flt Or Fmax Fmax Flt Or;
    Determinants: Fmul Fmul Fsub Fmul Fmul Fsub Fdiv Fmul Fmul Fsub Fdiv;
    Inside: Fle Fle And And Fadd Lw Fle And Fabs Lw Fle And;
    EnterPlanes: Lw Lw Add Lw Lw Fsub Fadd Fdiv Fabs;
    EnterBetween: Fsub Fmul Fsub Fmul Fmin Fmax Fmax Fmin;
    EnterVoxel: Fmul Fadd Lw Fsub Lw Fmul Ftoi Max Lw Addi Min Mov;
    Loads: Lw Lw;
    Entry: Lw Add;
    Product: Fmul Fadd;
    Difference: Fsub Fmul;
    Copies: Mov Mov;
}

impl Chain {
    /// The longest with which some steps begin.
    pub fn of(steps: &[Step]) -> Chain {
        let begins = |opcodes: &[Opcode]| {
            opcodes.len() <= steps.len() && steps.iter().zip(opcodes).all(|(step, &opcode)| step.opcode == opcode)
        };
        let longest = Chain::ALL.iter().filter(|(_, opcodes)| begins(opcodes)).max_by_key(|(_, opcodes)| opcodes.len());
        longest.map_or(Chain::One, |&(chain, _)| chain)
    }
}
