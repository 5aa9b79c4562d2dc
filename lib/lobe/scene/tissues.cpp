#include "lobe/scene/tissues.h"

#include <algorithm>
#include <array>

namespace lobe {
namespace {

// Young's modulus [Pa] of a tissue whose shear modulus G [Pa] was measured: E = 2 (1 + ν) G.
constexpr double from_shear(double shear_modulus) { return 2 * (1 + tissue_poisson_ratio) * shear_modulus; }

namespace source {
constexpr std::string_view ablation =
                               "Phys. Med. Biol. 64 (2019) 225001, doi 10.1088/1361-6560/ab5010, table 1",
                           arda = "Arda et al., Am. J. Roentgenol. (2011) 532-536, doi 10.2214/AJR.10.5449",
                           womb = "Sci. Rep. (2024), doi 10.1038/s41598-024-65238-3",
                           suction =
                               "In vivo measurement of breast tissues stiffness using a light aspiration "
                               "device (7 volunteers)",
                           neural = "J. Funct. Biomater. 3 (2012) 839-863, doi 10.3390/jfb3040839, table 1",
                           nguyen = "Nguyen et al., Ultrasound Med. Biol. 40 (2014) 168-176",
                           kerdok = "Kerdok et al., Med. Image Anal. 7 (2003) 283-291";
constexpr std::string_view acoustic =
                               "Mech. Mater. 44 (2012) 174-188, doi 10.1016/j.mechmat.2011.08.007, table 3",
                           kaye_laby = "Kaye and Laby, Tables of Physical and Chemical Constants, 2.4.6",
                           reference_man =
                               "Health Phys. 102 (2012), doi 10.1097/HP.0b013e318235163f, table 2",
                           water = "water, which gels are made of",
                           surgsim = "OpenSurgSim's test of the cube";
}  // namespace source

constexpr std::string_view quasistatic = "quasi-static shear modulus",
                           shear_waves = "127 healthy volunteers, shear-wave elastography";

constexpr std::array tissue_table{
    Tissue{"bile-duct", from_shear(166e3), from_shear(67e3), 1060, quasistatic, source::ablation,
           source::ablation},
    Tissue{"brain-grey-matter", from_shear(740), 0, 1040, "pig, shear modulus by indentation", source::neural,
           source::acoustic},
    Tissue{"brain-white-matter", from_shear(1030), 0, 1040, "pig, shear modulus by indentation",
           source::neural, source::acoustic},
    Tissue{"breast", 3040, 1170, 1020, "fatty and fibroglandular, aspiration in vivo", source::suction,
           source::acoustic},
    Tissue{"calf-muscle", 11.1e3, 4.1e3, 1050, shear_waves, source::arda, source::acoustic},
    Tissue{"diseased-liver", from_shear(19.8e3), 0, 1060, quasistatic, source::ablation, source::ablation},
    Tissue{"gallbladder", from_shear(85e3), from_shear(8.2e3), 1060, quasistatic, source::ablation,
           source::ablation},
    Tissue{"gelatin-3", from_shear(2010), from_shear(260), 1000, "3 % gelatin, shear-wave elastography",
           source::nguyen, source::water},
    Tissue{"gelatin-5", from_shear(4180), from_shear(840), 1000, "5 % gelatin, shear-wave elastography",
           source::nguyen, source::water},
    Tissue{"gelatin-7", from_shear(10240), from_shear(1800), 1000, "7 % gelatin, shear-wave elastography",
           source::nguyen, source::water},
    Tissue{"hepatic-artery", from_shear(210e3), from_shear(47e3), 1050, quasistatic, source::ablation,
           source::ablation},
    Tissue{"kidney", 5000, 2900, 1050, "cortex, shear-wave elastography", source::arda, source::acoustic},
    Tissue{"liver", from_shear(1800), from_shear(400), 1060, quasistatic, source::ablation, source::ablation},
    Tissue{"liver-tumour", from_shear(23.4e3), 0, 1060,
           "hepatocellular carcinoma, quasi-static shear modulus", source::ablation, source::ablation},
    Tissue{"pancreas", 4800, 3000, 1045, shear_waves, source::arda, source::kaye_laby},
    Tissue{"parotid-gland", 10.38e3, 3.5e3, 1030, shear_waves, source::arda, source::reference_man},
    Tissue{"skin", 56.3e3, 16.4e3, 1090, "of the breast, aspiration in vivo", source::suction,
           source::acoustic},
    Tissue{"spleen", 2900, 1800, 1054, shear_waves, source::arda, source::acoustic},
    Tissue{"stomach", from_shear(637), 0, 1058, quasistatic, source::ablation, source::ablation},
    Tissue{"thyroid", 10.97e3, 3.1e3, 1000, shear_waves, source::arda, source::kaye_laby},
    Tissue{"truth-cube", 15.3e3, 0, 980, "silicone RTV6166, compression of the cube", source::kerdok,
           source::surgsim},
    Tissue{"uterus", 6380, 2590, 1052, "myometrium of 27 women, shear-wave elastography", source::womb,
           source::kaye_laby},
};

}  // namespace

std::span<const Tissue> tissues() { return tissue_table; }

const Tissue* find_tissue(std::string_view name) {
  const auto found = std::find_if(tissue_table.begin(), tissue_table.end(),
                                  [&](const Tissue& tissue) { return tissue.name == name; });
  return found == tissue_table.end() ? nullptr : &*found;
}

}  // namespace lobe
