//! The table of instructions, from which encoding, assembler, manual and tests take what they know.

use super::field::Field;

/// A group of instructions that take equally many cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// Integer and bitwise arithmetic, moves, constants.
    Integer,
    /// Integer multiplication.
    Multiply,
    /// Integer division.
    Divide,
    /// A word from memory.
    Load,
    /// A word to memory.
    Store,
    /// What the floating-point adder does.
    FloatAdd,
    /// Floating-point multiplication.
    FloatMultiply,
    /// Floating-point division.
    FloatDivide,
    /// A floating-point comparison whose outcome is needed outside the floating-point unit.
    FloatCompare,
    /// Branches on integers, and jumps.
    Branch,
}

impl Class {
    /// All classes, in the order of the manual.
    pub const ALL: [Class; 10] = [
        Class::Integer,
        Class::Multiply,
        Class::Divide,
        Class::Load,
        Class::Store,
        Class::FloatAdd,
        Class::FloatMultiply,
        Class::FloatDivide,
        Class::FloatCompare,
        Class::Branch,
    ];

    /// Its name, as machine files have it.
    pub fn name(self) -> &'static str {
        match self {
            Class::Integer => "integer",
            Class::Multiply => "multiply",
            Class::Divide => "divide",
            Class::Load => "load",
            Class::Store => "store",
            Class::FloatAdd => "float_add",
            Class::FloatMultiply => "float_multiply",
            Class::FloatDivide => "float_divide",
            Class::FloatCompare => "float_compare",
            Class::Branch => "branch",
        }
    }
}

/// One operand of an instruction: what it means, and the fields that hold it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operand {
    /// A register or queue that is written.
    Write(Field),
    /// A register or queue that is read.
    Read(Field),
    /// A constant.
    Constant(Field),
    /// `[a + i]`: the word of memory at a register's value plus a constant, which are in these fields.
    Memory(Field, Field),
    /// An address in the program, held as the distance from the instruction itself.
    Target(Field),
}

/// How an instruction is written, and which fields it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// `d, a, b`
    Three,
    /// `d, a`
    Two,
    /// `d, a, i`
    TwoAndConstant,
    /// `d, i`
    Constant,
    /// `d, [a + i]`
    Load,
    /// `a, [b + i]`
    Store,
    /// `a, b, to`
    Branch,
    /// `to`
    Jump,
    /// `d, to`
    Call,
    /// `a`
    One,
    /// No operands.
    Bare,
}

impl Format {
    /// Its operands, in the order in which they are written and read.
    pub fn operands(self) -> &'static [Operand] {
        use Field::{First, Long, Second, Short, Third};
        match self {
            Format::Three => &[Operand::Write(First), Operand::Read(Second), Operand::Read(Third)],
            Format::Two => &[Operand::Write(First), Operand::Read(Second)],
            Format::TwoAndConstant => &[Operand::Write(First), Operand::Read(Second), Operand::Constant(Short)],
            Format::Constant => &[Operand::Write(First), Operand::Constant(Long)],
            Format::Load => &[Operand::Write(First), Operand::Memory(Second, Short)],
            Format::Store => &[Operand::Read(First), Operand::Memory(Second, Short)],
            Format::Branch => &[Operand::Read(First), Operand::Read(Second), Operand::Target(Short)],
            Format::Jump => &[Operand::Target(Long)],
            Format::Call => &[Operand::Write(First), Operand::Target(Long)],
            Format::One => &[Operand::Read(First)],
            Format::Bare => &[],
        }
    }

    /// How the operands are written, with the names that [`Entry::effect`] calls them by.
    pub fn syntax(self) -> &'static str {
        match self {
            Format::Three => "d, a, b",
            Format::Two => "d, a",
            Format::TwoAndConstant => "d, a, i",
            Format::Constant => "d, i",
            Format::Load => "d, [a + i]",
            Format::Store => "a, [b + i]",
            Format::Branch => "a, b, to",
            Format::Jump => "to",
            Format::Call => "d, to",
            Format::One => "a",
            Format::Bare => "",
        }
    }
}

/// What the table says of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Which one it is.
    pub opcode: Opcode,
    /// Its name in source text.
    pub mnemonic: &'static str,
    /// Its operands and fields.
    pub format: Format,
    /// What it costs.
    pub class: Class,
    /// What it does, in terms of the names of [`Format::syntax`].
    pub effect: &'static str,
    /// When it faults, beyond what any instruction can fault by; empty if never.
    pub faults: &'static str,
}

macro_rules! instructions {
    ($($name:ident $code:literal $mnemonic:literal $format:ident $class:ident $effect:literal $($faults:literal)?;)*) => {
        /// Which instruction, by its code in the encoded word.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum Opcode {
            $(#[doc = concat!("`", $mnemonic, "`: ", $effect)] $name = $code,)*
        }

        /// All instructions, in rising order of their codes.
        pub const TABLE: &[Entry] = &[$(Entry {
            opcode: Opcode::$name,
            mnemonic: $mnemonic,
            format: Format::$format,
            class: Class::$class,
            effect: $effect,
            faults: concat!($($faults)?),
        },)*];
    };
}

// The groups of sixteen are: 0 moves and memory, 1 and 2 integers, 3 and 4 floating point, 5 branches, 6 jumps and ends.
instructions! {
    Mov  0x01 "mov"  Two            Integer       "d = a; between a queue and a register, or two queues, it takes only the words' own cycles";
    Li   0x02 "li"   Constant       Integer       "d = i";
    Lw   0x03 "lw"   Load           Load          "d = the word of memory at address a + i" "the address is outside the memory";
    Sw   0x04 "sw"   Store          Store         "the word of memory at address b + i = a" "the address is outside the data memory";
    Add  0x10 "add"  Three          Integer       "d = a + b, modulo 2^32";
    Addi 0x11 "addi" TwoAndConstant Integer       "d = a + i, modulo 2^32";
    Sub  0x12 "sub"  Three          Integer       "d = a - b, modulo 2^32";
    Mul  0x13 "mul"  Three          Multiply      "d = a * b, modulo 2^32";
    Div  0x14 "div"  Three          Divide        "d = a / b, signed, rounded toward 0, modulo 2^32" "b is 0";
    Rem  0x15 "rem"  Three          Divide        "d = a - (a / b) * b, with div's quotient" "b is 0";
    Min  0x16 "min"  Three          Integer       "d = the lesser of a and b, signed";
    Max  0x17 "max"  Three          Integer       "d = the greater of a and b, signed";
    And  0x20 "and"  Three          Integer       "d = a and b, bit by bit";
    Or   0x21 "or"   Three          Integer       "d = a or b, bit by bit";
    Xor  0x22 "xor"  Three          Integer       "d = a exclusive-or b, bit by bit";
    Andi 0x23 "andi" TwoAndConstant Integer       "d = a and i, bit by bit, with i's sign in all upper bits";
    Shl  0x24 "shl"  TwoAndConstant Integer       "d = a shifted left by i modulo 32 bits, zeros coming in";
    Shr  0x25 "shr"  TwoAndConstant Integer       "d = a shifted right by i modulo 32 bits, zeros coming in";
    Sar  0x26 "sar"  TwoAndConstant Integer       "d = a shifted right by i modulo 32 bits, copies of the sign coming in";
    Seq  0x28 "seq"  Three          Integer       "d = 1 if a = b, else 0";
    Slt  0x29 "slt"  Three          Integer       "d = 1 if a < b, signed, else 0";
    Sltu 0x2a "sltu" Three          Integer       "d = 1 if a < b, unsigned, else 0";
    Fadd 0x30 "fadd" Three          FloatAdd      "d = a + b in floating point";
    Fsub 0x31 "fsub" Three          FloatAdd      "d = a - b in floating point";
    Fmul 0x32 "fmul" Three          FloatMultiply "d = a * b in floating point";
    Fdiv 0x33 "fdiv" Three          FloatDivide   "d = a / b in floating point; x / 0 is infinite, 0 / 0 no number";
    Fmin 0x34 "fmin" Three          FloatAdd      "d = a if a < b in floating point, else b: b if either is no number";
    Fmax 0x35 "fmax" Three          FloatAdd      "d = a if a > b in floating point, else b: b if either is no number";
    Fabs 0x36 "fabs" Two            FloatAdd      "d = a with its sign bit 0";
    Fneg 0x37 "fneg" Two            FloatAdd      "d = a with its sign bit changed";
    Ftoi 0x38 "ftoi" Two            FloatAdd      "d = the floating-point number a as an integer, rounded toward 0: the nearest that there is if it is too large, 0 if it is no number";
    Itof 0x39 "itof" Two            FloatAdd      "d = the signed integer a as the nearest floating-point number";
    Feq  0x40 "feq"  Three          FloatCompare  "d = 1 if a = b in floating point, else 0: 0 if either is no number";
    Flt  0x41 "flt"  Three          FloatCompare  "d = 1 if a < b in floating point, else 0: 0 if either is no number";
    Fle  0x42 "fle"  Three          FloatCompare  "d = 1 if a <= b in floating point, else 0: 0 if either is no number";
    Beq  0x50 "beq"  Branch         Branch        "goes on at to if a = b";
    Bne  0x51 "bne"  Branch         Branch        "goes on at to unless a = b";
    Blt  0x52 "blt"  Branch         Branch        "goes on at to if a < b, signed";
    Bge  0x53 "bge"  Branch         Branch        "goes on at to if a >= b, signed";
    Bltu 0x54 "bltu" Branch         Branch        "goes on at to if a < b, unsigned";
    Bgeu 0x55 "bgeu" Branch         Branch        "goes on at to if a >= b, unsigned";
    Fblt 0x58 "fblt" Branch         FloatCompare  "goes on at to if a < b in floating point: not if either is no number";
    Fble 0x59 "fble" Branch         FloatCompare  "goes on at to if a <= b in floating point: not if either is no number";
    Jmp  0x60 "jmp"  Jump           Branch        "goes on at to";
    Call 0x61 "call" Call           Branch        "d = the address of the next instruction; goes on at to";
    Jr   0x62 "jr"   One            Branch        "goes on at address a";
    Done 0x68 "done" Bare           Branch        "ends the message: the program starts again with the next, all registers 0 and the data memory as loaded; it takes no cycles";
    Halt 0x69 "halt" Bare           Branch        "stops the cell for good; it takes no cycles";
}

impl Opcode {
    /// The instruction with that code.
    pub fn from_code(code: u32) -> Option<Opcode> {
        let index = TABLE.binary_search_by_key(&code, |entry| entry.opcode as u32).ok()?;
        Some(TABLE[index].opcode)
    }

    /// The instruction with that name.
    pub fn named(mnemonic: &str) -> Option<Opcode> {
        TABLE.iter().find(|entry| entry.mnemonic == mnemonic).map(|entry| entry.opcode)
    }

    /// What the table says of it.
    pub fn entry(self) -> &'static Entry {
        let index = TABLE.partition_point(|entry| (entry.opcode as u8) < self as u8);
        &TABLE[index]
    }
}
