//! Super-instructions: sequences that programs execute often, each with code of its own, so that no instruction of it is looked
//! up by itself.

use super::executable::Step;
use super::processor::{Flow, Processor};
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
            /// All of them with their instructions. None is an end.
            const ALL: &[(Chain, &[Opcode])] = &[$((Chain::$name, &[$(Opcode::$opcode),+]),)*];
        }

        impl Processor<'_> {
            /// Executes the chain that begins some steps, the first of which is at an address, until an instruction of it does
            /// not lead to the next. Tells how many have led to the next, and where the one behind them leads.
            #[inline(always)]
            pub(super) fn execute_chain(&mut self, steps: &[Step], address: u32) -> (usize, Flow) {
                let Some(first) = steps.first() else { return (0, Flow::Next) };
                match first.chain {
                    $(Chain::$name => {
                        const LENGTH: usize = [$(Opcode::$opcode),+].len();
                        if let Some(steps) = steps.first_chunk::<LENGTH>() {
                            let mut done = 0;
                            $(
                                match self.execute(Opcode::$opcode, &steps[done], address + done as u32) {
                                    Flow::Next => done += 1,
                                    other => return (done, other),
                                }
                            )+
                            return (done, Flow::Next);
                        }
                    })*
                    Chain::One => {}
                }
                match self.execute(first.opcode, first, address) {
                    Flow::Next => (1, Flow::Next),
                    other => (0, other),
                }
            }
        }
    };
}

// Those of the standard programs, the loop of each kernel first.
chains! {
    Slab: Lw Fadd Fsub Fmul Lw Fsub Fsub Fmul Fmin Fmax Fmax Fmin;
    SlabsStart: Shl Shl Sub Lw Add Li Mov;
    Voxel: Lw Mul Add Add Lw Mul Add Lw Add;
    List: Lw Lw Beq;
    NextPolygon: Addi Bne Bne Fble Fble Jmp;
    Crossing: Fble Fble Jmp;
    CrossingZ: Fble Jmp;
    Cross: Fble Lw Beq Add Lw Add Lw Fsub Fmul Jmp;
    Plane: Lw Add Lw Lw Lw Lw Fmul Fmul Fadd Fmul Fadd Shl Beq;
    Meeting: Fmul Fmul Fadd Fmul Fadd Lw Fsub Fdiv Flt Fle And Fmul Fadd Fmul Fadd Fmul Fadd;
    Projection: Lw Andi Shr Addi Li Beq Blt;
    Projected: Mov Mov Addi Addi;
    Corner: Lw Lw Fsub Fsub;
    NextCorner: Mov Mov Addi Addi Lw Lw Fsub Fsub;
    Beside: Fmin Fmin Flt Fmax Fmax Flt Or;
    Beyond: Fmin Fmin Flt Or Fmax Fmax Flt Or;
    Determinants: Fmul Fmul Fsub Fmul Fmul Fsub Fdiv Fmul Fmul Fsub Fdiv;
    Inside: Fle Fle And And Fadd Lw Fle And Fabs Lw Fle And Bltu Addi Beq Bne;
    EnterPlanes: Lw Lw Add Lw Lw Fsub Fadd Fdiv Fabs Fblt;
    EnterBetween: Fsub Fmul Fsub Fmul Fmin Fmax Fmax Fmin;
    EnterVoxel: Fmul Fadd Lw Fsub Lw Fmul Ftoi Max Lw Addi Min Mov Beq;
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

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use proptest::prelude::*;

    use super::*;
    use crate::isa::kernels::float_wait;
    use crate::isa::{Executable, Instruction, InstructionCycles, Processor, Program, Queues, Register, Stop};
    use crate::seam::OpStream;

    /// Instructions of a chain, or some others: with few registers, small constants, and addresses that are mostly good.
    fn piece() -> impl Strategy<Value = Vec<u32>> {
        let chain = (0..Chain::ALL.len()).prop_map(|chain| Chain::ALL[chain].1.to_vec());
        let any = (0..crate::isa::table::TABLE.len()).prop_map(|entry| vec![crate::isa::table::TABLE[entry].opcode]);
        let opcodes = prop_oneof![4 => chain, 1 => any];
        let operands = prop::collection::vec(([0u32..6, 0u32..6, 0u32..6], 0u32..12, -3i32..9), 17);
        (opcodes, operands).prop_map(|(opcodes, operands)| {
            let instruction = |(opcode, (registers, odd, constant)): (Opcode, ([u32; 3], u32, i32))| {
                let mut registers = registers.map(|number| Register::new(number).unwrap_or(Register::ZERO));
                if matches!(opcode, Opcode::Lw | Opcode::Sw) && odd > 0 {
                    registers[1] = Register::ZERO;
                }
                // Branches go forward, but for some.
                let constant = if odd > 0 { constant.abs() + 1 } else { constant };
                let queued = [Register::X, Register::PASS_X, Register::Y][constant as usize % 3];
                if odd == 11 && queued != Register::PASS_X {
                    registers[0] = queued;
                }
                if odd == 10 {
                    registers[1] = queued;
                }
                let mut made = Instruction::new(opcode);
                for &field in opcode.fields() {
                    match field {
                        crate::isa::Field::First => made.set_register(field, registers[0]),
                        crate::isa::Field::Second => made.set_register(field, registers[1]),
                        crate::isa::Field::Third => made.set_register(field, registers[2]),
                        _ => made.constant = constant,
                    }
                }
                made.encode()
            };
            opcodes.into_iter().zip(operands).map(instruction).collect()
        })
    }

    thread_local! {
        /// Instructions that were executed, how many of the runs came to an end without a fault, and waits for results.
        static SEEN: Cell<[u64; 3]> = const { Cell::new([0; 3]) };
    }

    /// Waits for floating-point results among some ops.
    fn waited(ops: &OpStream) -> u64 {
        let is_wait = |unit| (0..4).any(|kernel| unit == float_wait(crate::seam::Activity(kernel)));
        let waits = ops.ops().iter().filter(|op| op.unit().is_some_and(is_wait));
        waits.map(|op| u64::from(op.count())).sum()
    }

    /// The interpreter that takes one instruction after the other is the judge of the one that runs ahead.
    #[test]
    fn running_ahead_does_what_single_steps_do() {
        let asked = ProptestConfig::default();
        let config = ProptestConfig { cases: asked.cases.max(3000), failure_persistence: None, ..asked };
        let mut runner = proptest::test_runner::TestRunner::new(config);
        let data =
            prop::collection::vec(prop_oneof![0u32..12, any::<u32>(), (-2.0f32..2.0).prop_map(f32::to_bits)], 16);
        let cases = (prop::collection::vec(piece(), 1..12), data, prop::collection::vec(0u32..200, 0..4), 20u64..600);
        let result = runner.run(&cases, |(pieces, data, marks, limit)| {
            let code: Vec<u32> = pieces.concat();
            let length = code.len() as u32;
            let work = (0..length).map(|address| crate::seam::Activity((address / 23 % 3) as u8)).collect();
            let counted = [("events".to_owned(), marks.iter().map(|mark| mark % length).collect())].into();
            let program = Program { code, work, data, counted, ..Program::default() };
            let cycles = InstructionCycles {
                integer: 1,
                multiply: 2,
                divide: 3,
                load: 4,
                store: 5,
                float_add: 6,
                float_multiply: 7,
                float_divide: 8,
                float_compare: 9,
                branch: 10,
                float_latency: Some(11),
            };
            let executable = Executable::new(program, &cycles);
            let cell = || Processor::new(&executable, &executable.program().data, &[7, 8, 9], limit);
            let (mut ahead, mut single) = (cell(), cell());
            let words = Queues { x: (0..20).collect(), y: (5..15).collect(), ..Queues::default() };
            let (mut ahead_queues, mut single_queues) = (words.clone(), words);
            let (mut ahead_ops, mut single_ops) = (OpStream::default(), OpStream::default());
            for _message in 0..3 {
                let by_runs = ahead.run(&mut ahead_queues, &mut ahead_ops);
                let by_steps = loop {
                    match single.step(&mut single_queues, &mut single_ops) {
                        Ok(None) => {}
                        Ok(Some(stop)) => break Ok(stop),
                        Err(fault) => break Err(fault),
                    }
                };
                prop_assert_eq!(&by_runs, &by_steps);
                prop_assert_eq!(
                    (ahead.executed(), ahead.cycles(), ahead.address()),
                    (single.executed(), single.cycles(), single.address())
                );
                prop_assert_eq!(ahead.counts(), single.counts());
                prop_assert_eq!(&ahead_queues, &single_queues);
                prop_assert_eq!(&ahead_ops, &single_ops);
                for register in Register::all() {
                    prop_assert_eq!(ahead.register(register), single.register(register), "{}", register);
                }
                for address in 0..19 {
                    prop_assert_eq!(ahead.memory(address), single.memory(address));
                }
                let [executed, ended, waits] = SEEN.get();
                SEEN.set([executed + ahead.executed(), ended + u64::from(by_runs.is_ok()), waits]);
                if by_runs != Ok(Stop::Done) {
                    break;
                }
            }
            let [executed, ended, waits] = SEEN.get();
            SEEN.set([executed, ended, waits + waited(&ahead_ops)]);
            Ok(())
        });
        result.unwrap_or_else(|error| panic!("{error}"));
        let [executed, ended, waits] = SEEN.get();
        assert!(
            executed > 30_000 && ended > 100 && waits > 3_000,
            "{executed} instructions, {ended} ends, {waits} waits"
        );
    }
}
