//! What each instruction does, once for the plain interpreter and for chains.

use super::executable::OUTSIDE;
use super::fault::FaultKind;
use super::processor::Processor;
use super::table::Opcode;

/// What an instruction comes to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Effect {
    /// A result for its first field, and on to the next instruction.
    Gives(u32),
    /// On to the next instruction.
    Passes,
    /// On to an address.
    Leads(u32),
    /// Nothing: it fails.
    Fails(FaultKind),
}

impl Processor<'_> {
    /// What an instruction comes to, of what its fields name and its constant or its target's address.
    #[inline(always)]
    pub(super) fn effect(&mut self, opcode: Opcode, [first, second, third]: [u32; 3], constant: u32) -> Effect {
        let (a, b, i) = (second, third, constant);
        let (fa, fb) = (f32::from_bits(a), f32::from_bits(b));
        let leads_if = |taken: bool| if taken { Effect::Leads(i) } else { Effect::Passes };
        let result = match opcode {
            Opcode::Mov => a,
            Opcode::Li => i,
            Opcode::Lw => match self.memory(a.wrapping_add(i)) {
                Some(word) => word,
                None => return self.load_fails(a.wrapping_add(i)),
            },
            Opcode::Sw => return self.store(a.wrapping_add(i), first),
            Opcode::Add => a.wrapping_add(b),
            Opcode::Addi => a.wrapping_add(i),
            Opcode::Sub => a.wrapping_sub(b),
            Opcode::Mul => a.wrapping_mul(b),
            Opcode::Div | Opcode::Rem if b == 0 => return Effect::Fails(FaultKind::DivisionByZero),
            Opcode::Div => (a as i32).wrapping_div(b as i32) as u32,
            Opcode::Rem => (a as i32).wrapping_rem(b as i32) as u32,
            Opcode::Min => (a as i32).min(b as i32) as u32,
            Opcode::Max => (a as i32).max(b as i32) as u32,
            Opcode::And => a & b,
            Opcode::Or => a | b,
            Opcode::Xor => a ^ b,
            Opcode::Andi => a & i,
            Opcode::Shl => a << (i & 31),
            Opcode::Shr => a >> (i & 31),
            Opcode::Sar => ((a as i32) >> (i & 31)) as u32,
            Opcode::Seq => (a == b) as u32,
            Opcode::Slt => ((a as i32) < b as i32) as u32,
            Opcode::Sltu => (a < b) as u32,
            Opcode::Fadd => (fa + fb).to_bits(),
            Opcode::Fsub => (fa - fb).to_bits(),
            Opcode::Fmul => (fa * fb).to_bits(),
            Opcode::Fdiv => (fa / fb).to_bits(),
            Opcode::Fmin => (if fa < fb { fa } else { fb }).to_bits(),
            Opcode::Fmax => (if fa > fb { fa } else { fb }).to_bits(),
            Opcode::Fabs => a & !SIGN,
            Opcode::Fneg => a ^ SIGN,
            // Rust's `as` is just what the instruction is to do.
            Opcode::Ftoi => fa as i32 as u32,
            Opcode::Itof => (a as i32 as f32).to_bits(),
            Opcode::Feq => (fa == fb) as u32,
            Opcode::Flt => (fa < fb) as u32,
            Opcode::Fle => (fa <= fb) as u32,
            Opcode::Beq => return leads_if(first == second),
            Opcode::Bne => return leads_if(first != second),
            Opcode::Blt => return leads_if((first as i32) < second as i32),
            Opcode::Bge => return leads_if(first as i32 >= second as i32),
            Opcode::Bltu => return leads_if(first < second),
            Opcode::Bgeu => return leads_if(first >= second),
            Opcode::Fblt => return leads_if(f32::from_bits(first) < f32::from_bits(second)),
            Opcode::Fble => return leads_if(f32::from_bits(first) <= f32::from_bits(second)),
            Opcode::Jmp | Opcode::Call => return Effect::Leads(i),
            Opcode::Jr => return Effect::Leads(first.min(OUTSIDE)),
            Opcode::Done | Opcode::Halt => return Effect::Passes,
        };
        Effect::Gives(result)
    }

    #[inline(always)]
    fn store(&mut self, address: u32, value: u32) -> Effect {
        let words = self.data.len() as u32;
        match self.data.get_mut(address as usize) {
            Some(word) => {
                *word = value;
                if !self.is_changed.replace(address as usize, true) {
                    self.changed.push(address);
                }
                Effect::Passes
            }
            None => Effect::Fails(FaultKind::Store { address, words }),
        }
    }

    #[cold]
    fn load_fails(&self, address: u32) -> Effect {
        let words = (self.data.len() + self.scene.len()) as u32;
        Effect::Fails(FaultKind::Load { address, words })
    }
}

const SIGN: u32 = 1 << 31;
