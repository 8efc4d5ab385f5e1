//! Names of quantities in several languages, and their usual role in hysteresis: English, German, French, Spanish, Russian,
//! Chinese and Japanese. A word that means two quantities, such as `Spannung`, is not here: its unit decides.

use crate::data::usual_role::Domain::{Electricity, Magnetism, Mechanics};
use crate::data::usual_role::UsualRole;

/// Lower-case words. Those in Chinese or Japanese may be part of a longer name.
#[rustfmt::skip]
const WORDS: &[(UsualRole, &str)] = &[
    (UsualRole::Drives(Mechanics),
     "displacement disp strain deflection elongation extension stroke travel drift rotation angle position \
      weg dehnung verschiebung auslenkung hub winkel verformung \
      déplacement deplacement déformation deformation allongement course \
      desplazamiento deformación deformacion alargamiento carrera \
      перемещение смещение деформация удлинение угол \
      位移 应变 变形 变位 変位 ひずみ 歪み 変形 转角 回転角"),
    (UsualRole::Follows(Mechanics),
     "force load stress torque moment pressure \
      kraft last drehmoment druck \
      effort charge contrainte couple pression \
      fuerza esfuerzo carga momento presión presion \
      сила нагрузка усилие момент давление \
      荷载 载荷 应力 扭矩 弯矩 恢复力 荷重 応力 トルク 復元力"),
    (UsualRole::Drives(Magnetism),
     "feldstärke feldstaerke magnetfeld champ campo напряженность \
      磁场强度 磁場強度 磁场 磁場 磁界"),
    (UsualRole::Follows(Magnetism),
     "flussdichte induktion induction inducción induccion magnetisation magnetization magnetisierung aimantation \
      индукция намагниченность \
      磁感应强度 磁通密度 磁束密度 磁化强度 磁化"),
    (UsualRole::Drives(Electricity),
     "voltage current strom courant voltaje corriente ток \
      电压 電圧 电流 電流"),
    (UsualRole::Follows(Electricity), "polarization polarisation polarización ladung поляризация 极化 分極"),
    (UsualRole::Accompanies,
     "temperature temp temperatur température temperatura температура humidity feuchte 温度 湿度"),
];

/// Lower-case words for an excitation. With one of them a force is an input.
const EXCITATION: [&str; 8] =
    ["excitation", "anregung", "excitación", "excitacion", "возбуждение", "激励", "加振", "励振"];

/// The role of a quantity by the words of its name; `None` if they give none, or several.
pub(super) fn part(quantity: &str) -> Option<UsualRole> {
    let lower = quantity.to_lowercase();
    let words: Vec<&str> =
        lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    // Magnetic words are longer names of the same characters: 磁化 in 磁化强度.
    let is_named = |word: &str| match word.is_ascii() || word.chars().all(|c| (c as u32) < 0x2e80) {
        true => words.contains(&word),
        false => lower.contains(word),
    };
    if EXCITATION.into_iter().any(is_named) {
        return Some(UsualRole::Excites);
    }
    let mut found =
        WORDS.iter().filter(|(_, words)| words.split_whitespace().any(is_named)).map(|(part, _)| *part);
    let first = found.next()?;
    found.next().is_none().then_some(first)
}
